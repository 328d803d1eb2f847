//! Spheres let fall one by one over places drawn from a seed: each rolls down to where three others, or walls, hold it, or to the
//! floor; a few stop on the way.
//!
//! The box is cut into cells by columns of the plane and by layers. A sphere meets those around its own column alone, from the highest
//! layer down as far as they can touch it, so the cost is linear in the number of spheres.

use nalgebra::{Matrix3, Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Spheres of the given radii (m) in a box of `size` (m) along x and z, with a floor at y = 0, each as [x, y, z, radius].
pub(crate) fn deposit_spheres(radii: &[f64], size: [f64; 2], seed: u64) -> Vec<[f64; 4]> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    // Not the numbers that the radii are drawn from.
    rng.set_stream(1);
    let mut heap = Heap::new(radii, size);
    for radius in radii {
        let mut over =
            || Vector2::from(size.map(|size| radius + (size - 2.0 * radius) * rng.random::<f64>()));
        let drawn: [Vector2<f64>; DRAWS] = std::array::from_fn(|_| over());
        let height = |over: &Vector2<f64>| heap.highest(*over, *radius).map_or(0.0, |(height, _)| height);
        let lower = |a: Vector2<f64>, b: Vector2<f64>| if height(&b) < height(&a) { b } else { a };
        let lowest = drawn[1..].iter().copied().fold(drawn[0], lower);
        heap.lay(heap.place(lowest, *radius), *radius);
    }
    heap.spheres.iter().map(|sphere| [sphere.at.x, sphere.at.y, sphere.at.z, sphere.radius]).collect()
}

/// Places that are drawn for a sphere at once: it falls over the lowest, so that the surface stays level.
const DRAWS: usize = 4;

/// Steps of a sphere that rolls, the first of them over its radius, and the next over the one before (–).
const STEPS: i32 = 60;
const FIRST_STEP: f64 = 0.15;
const SHORTER: f64 = 0.95;

/// The share of its direction that it keeps (–).
const ROLLS_ON: f64 = 0.7;

/// Distance within which a sphere that has rolled to a place finds its supports, over its radius (–).
const AROUND: f64 = 0.3;

/// Others that may hold a sphere.
const MOST_SUPPORTS: usize = 8;

/// Round-off of a place, over the size of the box (–).
const SLACK: f64 = 1e-12;

#[derive(Clone, Copy)]
struct Sphere {
    at: Vector3<f64>,
    radius: f64,
}

/// Support of a sphere.
#[derive(Clone, Copy)]
enum Support {
    /// Another, by its centre and the sum of both radii.
    Sphere(Vector3<f64>, f64),
    /// A wall or the floor: along an axis the centre is there, and pushed that way.
    Wall { axis: usize, at: f64, normal: f64 },
}

/// The spheres laid so far.
struct Heap {
    spheres: Vec<Sphere>,
    size: [f64; 2],
    /// Greatest radius (m).
    greatest: f64,
    /// Columns along x and z, and the size of one along each: a greatest diameter or more.
    counts: [usize; 2],
    column: [f64; 2],
    /// Spheres by column and layer, each a greatest diameter high.
    cells: Vec<Vec<Vec<u32>>>,
}

impl Heap {
    fn new(radii: &[f64], size: [f64; 2]) -> Self {
        let greatest = radii.iter().copied().fold(0.0, f64::max);
        let counts = size.map(|size| ((size / (2.0 * greatest)) as usize).clamp(1, radii.len().max(1)));
        let column = [size[0] / counts[0] as f64, size[1] / counts[1] as f64];
        let cells = vec![Vec::new(); counts[0] * counts[1]];
        Self { spheres: Vec::with_capacity(radii.len()), size, greatest, counts, column, cells }
    }

    fn column_of(&self, at: Vector2<f64>) -> [usize; 2] {
        [0, 1].map(|k| ((at[k] / self.column[k]) as usize).min(self.counts[k] - 1))
    }

    fn layer_of(&self, height: f64) -> usize {
        (height / (2.0 * self.greatest)) as usize
    }

    fn lay(&mut self, at: Vector3<f64>, radius: f64) {
        let ([x, z], layer) = (self.column_of(at.xz()), self.layer_of(at.y));
        let column = &mut self.cells[x + self.counts[0] * z];
        column.resize(column.len().max(layer + 1), Vec::new());
        column[layer].push(self.spheres.len() as u32);
        self.spheres.push(Sphere { at, radius });
    }

    /// The columns in which a sphere at [x, z] can touch others.
    fn around(&self, at: Vector2<f64>) -> impl Iterator<Item = &Vec<Vec<u32>>> {
        let [x, z] = self.column_of(at);
        let [columns, rows] = self.counts;
        let (x, z) = (x.saturating_sub(1)..(x + 2).min(columns), z.saturating_sub(1)..(z + 2).min(rows));
        z.flat_map(move |z| &self.cells[x.start + columns * z..x.end + columns * z])
    }

    /// The others that one at [x, z] can touch, of a layer.
    fn in_layer(&self, at: Vector2<f64>, layer: usize) -> impl Iterator<Item = &Sphere> {
        let cells = self.around(at).filter_map(move |column| column.get(layer));
        cells.flatten().map(|k| &self.spheres[*k as usize])
    }

    /// Layers around [x, z].
    fn layers(&self, at: Vector2<f64>) -> usize {
        self.around(at).map(Vec::len).max().unwrap_or(0)
    }

    /// The least height of a centre at [x, z] (m), and the sphere on which it then lies; `None` for the floor.
    fn highest(&self, at: Vector2<f64>, radius: f64) -> Option<(f64, &Sphere)> {
        let mut best: Option<(f64, &Sphere)> = None;
        for layer in (0..self.layers(at)).rev() {
            let top = 2.0 * self.greatest * (layer + 1) as f64;
            if best.is_some_and(|(height, _)| height >= top + self.greatest + radius) {
                break;
            }
            for other in self.in_layer(at, layer) {
                let least = best.map_or(radius, |(height, _)| height);
                if let Some(height) = bound(other, at, radius).filter(|height| *height > least) {
                    best = Some((height, other));
                }
            }
        }
        best
    }

    /// Returns the position at which a sphere that falls from [x, z] comes to rest: it rolls down the surface to which the others
    /// confine its centre, and lies where three of them, or walls, hold it, or on the floor; or it stays where it stopped on the
    /// way there.
    fn place(&self, over: Vector2<f64>, radius: f64) -> Vector3<f64> {
        let (mut at, mut down) = (over, Vector2::zeros());
        let (low, high) = (Vector2::repeat(radius), Vector2::from(self.size).add_scalar(-radius));
        for step in 0..STEPS {
            let Some((height, below)) = self.highest(at, radius) else { break };
            // Down the one on which it lies; and on, where it rolls between two.
            down = down * ROLLS_ON + (at - below.at.xz()) / (height - below.at.y);
            // Along walls where it is held.
            for axis in 0..2 {
                if at[axis] == low[axis] && down[axis] < 0.0 || at[axis] == high[axis] && down[axis] > 0.0 {
                    down[axis] = 0.0;
                }
            }
            let length = FIRST_STEP * radius * SHORTER.powi(step);
            at = (at + down * (length / down.norm().max(SLACK))).sup(&low).inf(&high);
        }
        let Some((height, _)) = self.highest(at, radius) else {
            return Vector3::new(at.x, radius, at.y);
        };
        let supports = self.supports(at, height, radius);
        let mut lowest: Option<Vector3<f64>> = None;
        for (k, a) in supports.iter().enumerate() {
            for (l, b) in supports.iter().enumerate().skip(k + 1) {
                for c in &supports[l + 1..] {
                    let better = |place: &Vector3<f64>| {
                        lowest.is_none_or(|lowest| place.y < lowest.y)
                            && (place.xz() - at).norm() <= radius
                            && is_held([a, b, c], *place)
                            && self.fits(*place, radius)
                    };
                    lowest = touching_three([a, b, c]).into_iter().flatten().find(better).or(lowest);
                }
            }
        }
        lowest.unwrap_or_else(|| Vector3::new(at.x, height, at.y))
    }

    /// Returns the supports of a sphere near [x, z] whose centre can be as low as `height` (m): the spheres that bound its height
    /// there, or nearly so, from the highest bound down; then the floor and the walls.
    fn supports(&self, at: Vector2<f64>, height: f64, radius: f64) -> Vec<Support> {
        let least = height - AROUND * radius;
        let layers = self.layer_of((least - self.greatest - radius).max(0.0))..self.layers(at);
        let mut bounds: Vec<(f64, &Sphere)> = layers
            .flat_map(|layer| self.in_layer(at, layer))
            .filter_map(|other| {
                let outside = (at - other.at.xz()).norm() - other.radius - radius;
                // One that is not below, but almost, counts by how far it is aside.
                let bound = bound(other, at, radius).unwrap_or(other.at.y - outside);
                (outside < AROUND * radius && bound > least).then_some((bound, other))
            })
            .collect();
        bounds.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        let spheres = bounds.iter().take(MOST_SUPPORTS);
        let mut supports: Vec<Support> =
            spheres.map(|(_, other)| Support::Sphere(other.at, other.radius + radius)).collect();
        let is_near = |at: f64, wall: f64| (at - wall).abs() <= AROUND * radius;
        if is_near(height, radius) {
            supports.push(Support::Wall { axis: 1, at: radius, normal: 1.0 });
        }
        for (k, axis) in [0, 2].into_iter().enumerate() {
            for (wall, normal) in [(radius, 1.0), (self.size[k] - radius, -1.0)] {
                if is_near(at[k], wall) {
                    supports.push(Support::Wall { axis, at: wall, normal });
                }
            }
        }
        supports
    }

    /// Reports whether a sphere fits at a place and can reach it from above, or by rolling off what lies a little higher.
    fn fits(&self, at: Vector3<f64>, radius: f64) -> bool {
        let slack = SLACK * (self.size[0] + self.size[1]);
        let inside = |x: f64, size: f64| x >= radius - slack && x <= size - radius + slack;
        let mut layers = self.layer_of((at.y - self.greatest - radius).max(0.0))..self.layers(at.xz());
        inside(at.x, self.size[0])
            && inside(at.z, self.size[1])
            && at.y >= radius - slack
            && layers.all(|layer| {
                self.in_layer(at.xz(), layer).all(|other| {
                    let (between, apart) = (at - other.at, radius + other.radius - slack);
                    let across = between.xz().norm_squared();
                    // What it would fall on right above the place is no more than it can roll off.
                    across >= apart * apart
                        || between.norm_squared() >= apart * apart
                            && (apart * apart - across).sqrt() - between.y <= radius
                })
            })
    }
}

/// The least height of a centre at [x, z] above another (m); `None` beside it.
fn bound(other: &Sphere, at: Vector2<f64>, radius: f64) -> Option<f64> {
    let distance = other.radius + radius;
    let height = distance * distance - (at - other.at.xz()).norm_squared();
    (height > 0.0).then(|| other.at.y + height.sqrt())
}

/// The places that touch all three: of those on three spheres the upper one, else up to two.
fn touching_three(supports: [&Support; 3]) -> [Option<Vector3<f64>>; 2] {
    match supports {
        [Support::Sphere(a, r_a), Support::Sphere(b, r_b), Support::Sphere(c, r_c)] => {
            // In the frame with a at the origin, b on the first axis and c in the plane of the first two.
            let (to_b, to_c) = (b - a, c - a);
            let d = to_b.norm();
            let e_x = to_b / d;
            let i = e_x.dot(&to_c);
            let across = to_c - e_x * i;
            let j = across.norm();
            let e_y = across / j;
            let x = (r_a * r_a - r_b * r_b + d * d) / (2.0 * d);
            let y = (r_a * r_a - r_c * r_c + i * i + j * j) / (2.0 * j) - x * i / j;
            let height = r_a * r_a - x * x - y * y;
            let e_z = e_x.cross(&e_y);
            let up = if e_z.y < 0.0 { -e_z } else { e_z };
            [(height >= 0.0).then(|| a + e_x * x + e_y * y + up * height.sqrt()), None]
        }
        [Support::Sphere(a, r_a), Support::Sphere(b, r_b), Support::Wall { axis, at, .. }] => {
            // Two circles in the plane of the centres along the wall.
            let flat = |c: &Vector3<f64>| c.remove_row(*axis);
            let squared_radius = |c: &Vector3<f64>, r: f64| r * r - (c[*axis] - at) * (c[*axis] - at);
            let (s_a, s_b) = (squared_radius(a, *r_a), squared_radius(b, *r_b));
            let along = flat(b) - flat(a);
            let squared = along.norm_squared();
            let share = (s_a - s_b + squared) / (2.0 * squared);
            let height = s_a / squared - share * share;
            if !(height >= 0.0) {
                return [None; 2];
            }
            let across = Vector2::new(-along.y, along.x) * height.sqrt();
            [across, -across].map(|across| Some((flat(a) + along * share + across).insert_row(*axis, *at)))
        }
        [
            Support::Sphere(a, r_a),
            Support::Wall { axis, at, .. },
            Support::Wall { axis: other, at: there, .. },
        ] if axis != other => {
            let mut place = *a;
            (place[*axis], place[*other]) = (*at, *there);
            let height = r_a * r_a - (place - a).norm_squared();
            let along = Vector3::ith(3 - axis - other, height.max(0.0).sqrt());
            if height >= 0.0 { [Some(place + along), Some(place - along)] } else { [None; 2] }
        }
        _ => [None; 2],
    }
}

/// Reports whether three supports carry a weight at a place, each pushing: Σ n f = (0, 1, 0) with f ≥ 0.
fn is_held(supports: [&Support; 3], at: Vector3<f64>) -> bool {
    let normal = |support: &Support| match support {
        Support::Sphere(centre, distance) => (at - centre) / *distance,
        Support::Wall { axis, normal, .. } => Vector3::ith(*axis, *normal),
    };
    let normals = Matrix3::from_columns(&supports.map(normal));
    normals.lu().solve(&Vector3::y()).is_some_and(|forces| forces.iter().all(|force| *force >= -1e-12))
}

#[cfg(test)]
mod tests;
