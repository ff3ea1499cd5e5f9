//! Mirrors and glass, against exact rays: balls, boxes, slabs and a plane, which are met, mirrored at and refracted by closed
//! formulas in `f64`. Nothing here is shared with the renderer.

use sdf_lang::Options;
use sdf_tests::light::View;
use sdf_tests::light::vector::{Vector, difference as apart, dot, minus, mixed, plus, times, unit};

/// A scene for both: the surfaces give light of their own alone, which changes slowly, so that it shows where a ray ends.
struct World {
    items: Vec<Item>,
    bounces: u32,
    fog: f64,
}

struct Item {
    solid: Solid,
    matter: Matter,
}

enum Solid {
    /// Centre and radius.
    Ball(Vector, f64),
    /// Centre and half sides.
    Box(Vector, Vector),
    /// Below this height.
    Floor(f64),
}

#[derive(Clone, Copy)]
struct Matter {
    emission: Vector,
    reflect: f64,
    transmit: f64,
    ior: f64,
}

const FOG: Vector = [0.5, 0.1, 0.4];
const HORIZON: Vector = [0.3, 0.25, 0.2];
const ZENITH: Vector = [0.02, 0.05, 0.4];

/// A material's light at a place: a slow wave of its colour along x and z.
fn emitted(matter: &Matter, p: Vector) -> Vector {
    times(matter.emission, 0.6 + 0.4 * (1.5 * p[0]).sin() * (1.1 * p[2]).cos())
}

impl World {
    /// The scene as a file.
    fn text(&self) -> String {
        let mut text = format!(
            "light none {{ direction: (0, 1, 0), intensity: 0 }}
             ambient {{ color: 0 }}
             sky {{ horizon: ({}, {}, {}), zenith: ({}, {}, {}) }}
             render {{ bounces: {}, tolerance: 0.01 }}\n",
            HORIZON[0], HORIZON[1], HORIZON[2], ZENITH[0], ZENITH[1], ZENITH[2], self.bounces
        );
        if self.fog > 0.0 {
            text +=
                &format!("fog {{ density: {}, color: ({}, {}, {}) }}\n", self.fog, FOG[0], FOG[1], FOG[2]);
        }
        text += "scene {\n";
        for Item { solid, matter } in &self.items {
            // Where the shape stands is where its material's `p` is zero.
            let (shape, [x, y, z]) = match *solid {
                Solid::Ball(at, r) => (format!("sphere({r})"), at),
                Solid::Box(at, [a, b, c]) => (format!("box(({a}, {b}, {c}))"), at),
                Solid::Floor(y) => ("plane()".into(), [0.0, y, 0.0]),
            };
            let [r, g, b] = matter.emission;
            text += &format!(
                "  {shape}.paint(material {{ color: 0, specular: 0, reflect: {}, transmit: {}, ior: {},
                    emission: ({r}, {g}, {b}) * (0.6 + 0.4 * sin(1.5 * (p.x + {x})) * cos(1.1 * (p.z + {z}))) }}).at({x}, {y}, {z}),\n",
                matter.reflect, matter.transmit, matter.ior
            );
        }
        text + "}"
    }

    /// The light along a ray that may go on so many times, within the item at `inside` if there is one.
    fn light(&self, origin: Vector, direction: Vector, left: u32, inside: Option<usize>) -> Vector {
        let met = self.items.iter().enumerate().flat_map(|(i, item)| {
            let crossings = item.solid.crossings(origin, direction);
            crossings.into_iter().map(move |(t, normal)| (t, normal, i))
        });
        // Where glass stands on something opaque, that is what is met.
        let first = |(t, _, i): &(f64, Vector, usize)| {
            *t + if self.items[*i].matter.transmit > 0.0 { 1e-9 } else { 0.0 }
        };
        let met = met.filter(|(t, ..)| *t > 1e-9).min_by(|a, b| first(a).total_cmp(&first(b)));
        let Some((t, normal, index)) = met else {
            let sky = mixed(HORIZON, ZENITH, direction[1].max(0.0));
            return self.through_fog(sky, 100.0);
        };
        let place = plus(origin, times(direction, t));
        let matter = &self.items[index].matter;
        let normal = if dot(normal, direction) > 0.0 { times(normal, -1.0) } else { normal };
        let own = emitted(matter, place);
        if left == 0 {
            return self.through_fog(own, t);
        }
        let through = matter.transmit;
        let mirrored = matter.reflect * (1.0 - through);
        let mut light = times(own, 1.0 - through - mirrored);
        let mirror = minus(direction, times(normal, 2.0 * dot(direction, normal)));
        if mirrored > 0.0 {
            light = plus(light, times(self.light(place, mirror, left - 1, inside), mirrored));
        }
        if through > 0.0 {
            // Snell's law: the part along the surface is scaled by the ratio of the indices.
            let ratio = if inside.is_some() { matter.ior } else { 1.0 / matter.ior };
            let cosine = -dot(direction, normal);
            let sine = ratio * (1.0 - cosine * cosine).max(0.0).sqrt();
            let (way, inside) = if sine > 1.0 {
                (mirror, inside)
            } else {
                let along = times(plus(direction, times(normal, cosine)), ratio);
                let down = times(normal, -(1.0 - sine * sine).sqrt());
                (plus(along, down), if inside.is_some() { None } else { Some(index) })
            };
            light = plus(light, times(self.light(place, way, left - 1, inside), through));
        }
        self.through_fog(light, t)
    }

    fn through_fog(&self, light: Vector, t: f64) -> Vector {
        if self.fog > 0.0 { mixed(FOG, light, (-self.fog * t).exp()) } else { light }
    }
}

impl Solid {
    /// Where a line crosses the surface, and the normals there.
    fn crossings(&self, origin: Vector, direction: Vector) -> Vec<(f64, Vector)> {
        match *self {
            Solid::Ball(center, r) => {
                let to = minus(origin, center);
                let (b, c) = (dot(to, direction), dot(to, to) - r * r);
                let root = b * b - c;
                if root < 0.0 {
                    return Vec::new();
                }
                let at = |t: f64| (t, unit(plus(to, times(direction, t))));
                vec![at(-b - root.sqrt()), at(-b + root.sqrt())]
            }
            Solid::Box(center, half) => {
                let (mut enter, mut leave) = ((f64::NEG_INFINITY, [0.0; 3]), (f64::INFINITY, [0.0; 3]));
                for k in 0..3 {
                    let at = |side: f64| (center[k] + side * half[k] - origin[k]) / direction[k];
                    let normal = std::array::from_fn(|i| if i == k { -direction[k].signum() } else { 0.0 });
                    let (near, far) = (at(-direction[k].signum()), at(direction[k].signum()));
                    if near > enter.0 {
                        enter = (near, normal);
                    }
                    if far < leave.0 {
                        leave = (far, normal);
                    }
                }
                if enter.0 < leave.0 { vec![enter, leave] } else { Vec::new() }
            }
            Solid::Floor(y) => vec![((y - origin[1]) / direction[1], [0.0, 1.0, 0.0])],
        }
    }
}

const VIEW: View = View { eye: [2.5, 1.8, 4.0], target: [0.1, 0.5, 0.0], fov: 45.0, size: [96, 54] };

/// How far a colour may be from what exact rays see within a tenth of a pixel, in linear light.
const NEAR: f64 = 4e-3;
/// How far apart what they see may be: where it is more, an edge lies between them, and nothing is compared.
const EDGE: f64 = 0.02;

/// How many pixels of a world are compared, and how many of them differ by more than may be.
fn compared(world: &World, options: &Options) -> (usize, usize) {
    let found = VIEW.light(&world.text(), options);
    let directions = VIEW.directions();
    let width = VIEW.size[0] as usize;
    let (mut all, mut wrong) = (0, 0);
    for (i, direction) in directions.iter().enumerate() {
        let exact = |direction: Vector| world.light(VIEW.eye, direction, world.bounces, None);
        let wanted = exact(*direction);
        let (row, column) = (i / width, i % width);
        let beside = [
            directions[row * width + if column > 0 { column - 1 } else { column + 1 }],
            directions[if row > 0 { i - width } else { i + width }],
        ];
        let spread = beside.iter().flat_map(|other| {
            let step = times(minus(*other, *direction), 0.1);
            [1.0, -1.0].map(|sign| apart(exact(unit(plus(*direction, times(step, sign)))), wanted))
        });
        let spread = spread.fold(0.0, f64::max);
        if spread < EDGE {
            all += 1;
            wrong += usize::from(apart(wanted, found[i]) >= NEAR + spread);
        }
    }
    (all, wrong)
}

fn opaque(emission: Vector) -> Matter {
    Matter { emission, reflect: 0.0, transmit: 0.0, ior: 1.5 }
}

/// A mirroring ball and box over a floor that mirrors a little.
fn mirrors(fog: f64) -> World {
    let mirror = |emission, reflect| Matter { reflect, ..opaque(emission) };
    World {
        items: vec![
            Item { solid: Solid::Ball([0.0, 0.8, 0.0], 0.8), matter: mirror([0.2, 0.2, 0.3], 0.85) },
            Item {
                solid: Solid::Box([1.5, 0.4, 0.6], [0.4, 0.4, 0.3]),
                matter: mirror([0.8, 0.3, 0.1], 0.4),
            },
            Item { solid: Solid::Ball([-1.3, 0.4, 0.9], 0.4), matter: opaque([0.1, 0.7, 0.3]) },
            Item { solid: Solid::Floor(0.0), matter: mirror([0.5, 0.45, 0.4], 0.25) },
        ],
        bounces: 3,
        fog,
    }
}

/// A ball and a slab of glass before and above things that are opaque; the slab's sides reflect totally.
fn glass(reflect: f64) -> World {
    let clear = |ior| Matter { emission: [0.3, 0.4, 0.3], reflect, transmit: 0.85, ior };
    World {
        items: vec![
            Item { solid: Solid::Ball([0.6, 0.7, 0.9], 0.55), matter: clear(1.5) },
            Item { solid: Solid::Box([-0.9, 0.5, 0.4], [0.7, 0.15, 0.8]), matter: clear(1.33) },
            Item { solid: Solid::Ball([-0.2, 0.5, -1.1], 0.5), matter: opaque([0.1, 0.7, 0.3]) },
            Item { solid: Solid::Floor(0.0), matter: opaque([0.7, 0.5, 0.4]) },
        ],
        bounces: 4,
        fog: 0.0,
    }
}

/// Glass that stands on a floor, and holds something opaque.
fn filled() -> World {
    let clear = Matter { emission: [0.1, 0.2, 0.4], reflect: 0.0, transmit: 0.7, ior: 1.4 };
    World {
        items: vec![
            Item { solid: Solid::Box([0.2, 0.5, 0.1], [0.8, 0.5, 0.6]), matter: clear },
            Item { solid: Solid::Ball([0.2, 0.45, 0.1], 0.3), matter: opaque([0.8, 0.1, 0.1]) },
            Item { solid: Solid::Floor(0.0), matter: opaque([0.7, 0.6, 0.3]) },
        ],
        bounces: 3,
        fog: 0.0,
    }
}

/// At most so many of a thousand compared pixels may differ: rays that pass an edge by less than the tolerance.
fn assert_exact(name: &str, world: &World, least: usize) {
    let (all, wrong) = compared(world, &Options::default());
    println!("{name}: {wrong} of {all} pixels differ from exact rays by {NEAR} and more");
    assert!(all > least && wrong * 1000 <= all, "{name}: {wrong} of {all}");
}

#[test]
fn mirrors_show_what_exact_rays_meet() {
    assert_exact("mirrors", &mirrors(0.0), 4000);
    assert_exact("mirrors in fog", &mirrors(0.1), 4000);
}

#[test]
fn glass_shows_what_exact_rays_meet() {
    assert_exact("glass", &glass(0.0), 4000);
    assert_exact("glass that reflects", &glass(0.3), 4000);
    assert_exact("glass on a floor and round a ball", &filled(), 4000);
}

/// A world drawn with another text in the place of a part of one of the renderer's files.
fn with_twin(world: &World, file: &str, from: &str, to: &str) -> (usize, usize) {
    let text = sdf_lang::compiler_files().find(|(name, _)| *name == file).expect("a file").1;
    assert!(text.contains(from), "{file} has no {from}");
    let replaced = vec![(file.to_owned(), text.replace(from, to))];
    compared(world, &Options { replaced, ..Options::default() })
}

/// From within something opaque its walls are seen, painted or not, above a floor that the eye is outside of; and glass in it that
/// bends no light is not seen.
#[test]
fn an_eye_within_something_opaque_sees_its_walls() {
    let view = View { eye: [0.0, 1.0, 0.0], target: [1.0, 1.0, -3.0], fov: 80.0, size: [64, 36] };
    let seen = |wall: &str, ball: &str| {
        let text = format!(
            "ambient {{ color: 0.5 }} light off {{ direction: 1, intensity: 0 }}
            scene {{ plane(offset: 3).paint(#ff0000), box((3, 2, 3)){wall}, {ball} }}"
        );
        view.light(&text, &Options::default())
    };
    for (wall, color) in [("", [0.4, 0.4, 0.4]), (".paint((0.6, 0.4, 0.2))", [0.3, 0.2, 0.1])] {
        let glass = "sphere(0.6).at(1, 1, -2).paint(material { transmit: 1, ior: 1 })";
        for ball in ["", glass] {
            let seen = seen(wall, ball);
            let right = seen.iter().filter(|light| apart(**light, color) < 1e-3).count();
            // Not at the rim of the ball.
            assert!(right * 100 >= seen.len() * 99, "{wall} {ball}: {right} of {}", seen.len());
        }
    }
}

#[test]
fn without_what_makes_them_right_they_differ() {
    for (world, file, from, to) in [
        // The law upside down.
        (glass(0.0), "transmit.sdf", "{ 1 / ior } else { ior }", "{ ior } else { 1 / ior }"),
        // Without total reflection.
        (
            glass(0.0),
            "transmit.sdf",
            "direction: if is_total { reflect(direction, at.normal) } else { bent }",
            "direction: bent",
        ),
        // One field for all, in which glass has no border where it stands.
        (filled(), "transmit.sdf", "+ 2 * tolerance", "- 2 * tolerance"),
        // Who forgets the other way.
        (glass(0.3), "path.sdf", "if forks { pushed(pile, through, size) }", "if forks { pile }"),
        (mirrors(0.0), "path.sdf", "left: s.next.left - 1", "left: s.next.left - 2"),
        (mirrors(0.1), "path.sdf", "way.weight * clear", "way.weight"),
    ] {
        let (all, wrong) = with_twin(&world, file, from, to);
        assert!(wrong * 100 > all, "{from} → {to}: only {wrong} of {all} differ");
    }
}
