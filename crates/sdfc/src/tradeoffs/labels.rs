//! Names beside the points of a plot: none upon another.

/// The height of a line, and how wide a character is at most in the mean, in pixels.
const LINE: i32 = 15;
const WIDTH: f64 = 6.5;
/// How far a name is from its point, and how much farther each time that there is no room.
const NEAR: i32 = 9;
const FARTHER: i32 = 8;
/// How far names are apart that stand beside each other.
const GAP: i32 = 5;
/// At how many places of a line it is asked whether a name is there.
const STOPS: i32 = 32;
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

impl Placed {
    /// The line to its point.
    pub fn leader(&self) -> [(i32, i32); 2] {
        [self.at, self.rect.nearest(self.at)]
    }

    /// Whether it is upon another name.
    fn is_upon(&self, other: &Placed) -> bool {
        self.rect.meets(&other.room())
    }

    /// Whether its line is.
    fn crosses(&self, other: &Placed) -> bool {
        let [from, to] = self.leader();
        let on_line = |i: i32| (from.0 + (to.0 - from.0) * i / STOPS, from.1 + (to.1 - from.1) * i / STOPS);
        self.is_led && (0..=STOPS).any(|i| Rect::around(on_line(i), 0).meets(&other.room()))
    }

    fn room(&self) -> Rect {
        Rect { left: self.rect.left - GAP, right: self.rect.right + GAP, ..self.rect }
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
        let candidates = candidates(label, rings).into_iter().map(|(rect, ring)| {
            let is_led = ring > 1 || is_of_another(&rect);
            (Placed { text: label.text.clone(), at: label.at, rect, is_led }, ring)
        });
        let hits = |all: &[Rect], rect: &Rect| all.iter().filter(|other| other.meets(rect)).count() as i32;
        let free = candidates
            .filter(|(new, _)| new.rect.is_within(inside) && !placed.iter().any(|old| old.is_upon(new)));
        let with_cost = free.map(|(new, ring)| {
            let crossed = placed.iter().filter(|old| old.crosses(&new) || new.crosses(old)).count() as i32;
            let hits = 12 * hits(points, &new.rect) + 3 * hits(lines, &new.rect);
            let cost = ring + hits + 3 * i32::from(is_of_another(&new.rect)) + 40 * crossed;
            (new, cost)
        });
        let best = with_cost.min_by_key(|(_, cost)| *cost);
        placed.extend(best.filter(|(_, cost)| label.must || *cost <= 4).map(|(new, _)| new));
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
    fn no_line_goes_through_a_name() {
        let at = |x| (x, 290);
        let points: Vec<Rect> = (0..40).map(|i| Rect::around(at(10 * i), 9)).collect();
        let labels = [200, 212].map(|x| label("a long name", at(x), true));
        let placed = place(&labels, &INSIDE, &points, &[]);
        for (i, a) in placed.iter().enumerate() {
            assert!(a.is_led && placed[..i].iter().all(|b| !b.crosses(a) && !a.crosses(b)), "{placed:?}");
        }
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
