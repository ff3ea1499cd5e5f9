//! Names beside the points of a plot: none upon another.

/// The height of a line, and how wide a character is at most in the mean, in pixels.
const LINE: i32 = 15;
const WIDTH: f64 = 6.5;
/// How far a name is from its point, and how much farther each time that there is no room.
const NEAR: i32 = 9;
const FARTHER: i32 = 8;
/// How often a name that must be told moves on.
const RINGS: i32 = 48;

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rect {
    pub left: i32,
    pub top: i32,
    pub right: i32,
    pub bottom: i32,
}

/// A name, and the point that it is of.
#[derive(Debug, Clone)]
pub struct Label {
    pub text: String,
    pub at: (i32, i32),
    /// Whether it is told even where there is no room near its point.
    pub must: bool,
}

/// A name that has a place.
#[derive(Debug, Clone, PartialEq)]
pub struct Placed {
    pub text: String,
    /// Its point.
    pub at: (i32, i32),
    pub rect: Rect,
    /// Whether a line must lead to its point, since that is far or another one is nearer.
    pub is_led: bool,
}

impl Rect {
    /// Round a point.
    pub fn around((x, y): (i32, i32), radius: i32) -> Rect {
        Rect { left: x - radius, top: y - radius, right: x + radius, bottom: y + radius }
    }

    fn meets(&self, other: &Rect) -> bool {
        self.left <= other.right
            && other.left <= self.right
            && self.top <= other.bottom
            && other.top <= self.bottom
    }

    fn is_within(&self, other: &Rect) -> bool {
        self.left >= other.left
            && self.right <= other.right
            && self.top >= other.top
            && self.bottom <= other.bottom
    }

    /// The square of how far a point is from it.
    fn distance(&self, at: (i32, i32)) -> i32 {
        let (x, y) = self.nearest(at);
        (at.0 - x).pow(2) + (at.1 - y).pow(2)
    }

    fn middle(&self) -> (i32, i32) {
        ((self.left + self.right) / 2, (self.top + self.bottom) / 2)
    }

    /// The point of it that is nearest to another.
    pub fn nearest(&self, (x, y): (i32, i32)) -> (i32, i32) {
        (x.clamp(self.left, self.right), y.clamp(self.top, self.bottom))
    }
}

/// How wide a text is at most, in pixels.
pub fn width(text: &str) -> i32 {
    (text.chars().count() as f64 * WIDTH).ceil() as i32
}

/// Finds places for names, the first first. They lie inside, and not upon each other nor, if that can be, upon `points` and
/// `lines`. What need not be told is left out where there is no room.
pub fn place(labels: &[Label], inside: &Rect, points: &[Rect], lines: &[Rect]) -> Vec<Placed> {
    let mut placed: Vec<Placed> = Vec::new();
    for label in labels {
        let rings = if label.must { RINGS } else { 2 };
        let is_of_another = |rect: &Rect| {
            let own = rect.distance(label.at);
            points.iter().any(|point| point.middle() != label.at && rect.distance(point.middle()) <= own)
        };
        let cost = |rect: &Rect, ring: i32| {
            let hit = |all: &[Rect]| all.iter().filter(|other| other.meets(rect)).count() as i32;
            ring + 12 * hit(points) + 3 * hit(lines) + 3 * i32::from(is_of_another(rect))
        };
        let free = candidates(label, rings)
            .into_iter()
            .filter(|(rect, _)| rect.is_within(inside) && !placed.iter().any(|other| other.rect.meets(rect)));
        let best = free.min_by_key(|(rect, ring)| cost(rect, *ring));
        let Some((rect, ring)) = best.filter(|(rect, ring)| label.must || cost(rect, *ring) <= 4) else {
            continue;
        };
        let is_led = ring > 1 || is_of_another(&rect);
        placed.push(Placed { text: label.text.clone(), at: label.at, rect, is_led });
    }
    placed
}

/// Where a name may stand, and how far out: right, left, above and below of its point, and at the corners.
fn candidates(label: &Label, rings: i32) -> Vec<(Rect, i32)> {
    let (x, y) = label.at;
    let width = width(&label.text);
    let sides = [(1, 0), (1, -1), (1, 1), (-1, 0), (-1, -1), (-1, 1), (0, -1), (0, 1)];
    let mut all = Vec::new();
    for ring in 0..rings {
        let far = NEAR + FARTHER * ring;
        for (across, down) in sides {
            // At a corner it is as far away as at a side.
            let far = if across != 0 && down != 0 { far * 3 / 4 } else { far };
            let left = match across {
                1 => x + far,
                -1 => x - far - width,
                _ => x - width / 2,
            };
            let top = match down {
                1 => y + far,
                -1 => y - far - LINE,
                _ => y - LINE / 2,
            };
            all.push((Rect { left, top, right: left + width, bottom: top + LINE }, ring));
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::{Label, Rect, place};

    const INSIDE: Rect = Rect { left: 0, top: 0, right: 400, bottom: 300 };

    fn label(text: &str, at: (i32, i32), must: bool) -> Label {
        Label { text: text.into(), at, must }
    }

    #[test]
    fn names_of_one_place_are_apart() {
        for at in [(200, 150), (0, 0), (400, 300), (1, 299)] {
            let labels: Vec<Label> = (0..12).map(|i| label(&format!("name {i}"), at, true)).collect();
            let placed = place(&labels, &INSIDE, &[Rect::around(at, 5)], &[]);
            assert_eq!(placed.len(), labels.len(), "{at:?}");
            for (i, a) in placed.iter().enumerate() {
                assert!(a.rect.is_within(&INSIDE) && !a.rect.meets(&Rect::around(at, 5)), "{a:?}");
                assert!(placed[..i].iter().all(|b| !b.rect.meets(&a.rect)), "{placed:?}");
            }
        }
    }

    #[test]
    fn a_name_is_nearest_to_its_own_point() {
        let points = [(200, 150), (214, 150), (200, 164), (200, 136)].map(|at| Rect::around(at, 5));
        let names = place(&[label("a name", (200, 150), true)], &INSIDE, &points, &[]);
        assert_eq!((names[0].rect.right, names[0].is_led), (191, false), "{names:?}");
        let around = [points, [(186, 150), (190, 140), (190, 160), (210, 140)].map(|at| Rect::around(at, 5))];
        let names = place(&[label("a name", (200, 150), true)], &INSIDE, &around.concat(), &[]);
        assert!(names[0].is_led, "{names:?}");
    }

    #[test]
    fn what_need_not_be_told_gives_way() {
        let points: Vec<Rect> = (0..40).map(|i| Rect::around((10 * i, 150), 24)).collect();
        let names = |must| place(&[label("a name", (200, 150), must)], &INSIDE, &points, &[]);
        assert_eq!(names(false), []);
        let [name] = &names(true)[..] else { panic!("it must be told") };
        assert!(name.is_led && points.iter().all(|point| !point.meets(&name.rect)), "{name:?}");
        assert_eq!(place(&[label("a name", (200, 150), false)], &INSIDE, &[], &[]).len(), 1);
    }
}
