//! Points of declared domains: products of regions over the coordinates in their order.

use std::path::Path;

use nisp::Points;
use nisp::schema::{Coordinate, FileKind, Group, Place, Portion, Region};
use nisp_data::cloud::Surface;
use nisp_data::domain::{Domain, Sampling};
use nisp_data::{DataError, Table};

/// Points on a line, over an area and in a volume, or in more dimensions, for equations of second order.
const POINTS: [usize; 3] = [160, 800, 2000];
/// How many times more points an edge over one coordinate has. Cells may get finer than its points are apart, and between its points
/// no condition holds.
const EDGE: usize = 4;

/// A domain whose regions have been checked.
pub(crate) struct Body {
    factors: Vec<Domain>,
}

/// Points of a group that lies in a domain.
#[derive(Default)]
pub(crate) struct Placed {
    /// The points, with weights that add up to the size of the portion.
    pub(crate) points: Points,
    /// Of a boundary, the outward normal at each point, one entry for each coordinate of the first region.
    pub(crate) normals: Vec<Vec<f64>>,
}

impl Body {
    /// A domain as declared over these coordinates; files are looked for from a folder.
    ///
    /// # Errors
    /// A file that cannot be read, a polygon that crosses itself, a surface that is not closed.
    pub(crate) fn new(regions: &[Region], coordinates: &[Coordinate], folder: &Path) -> Result<Self, DataError> {
        let mut left = coordinates;
        let mut factors = Vec::new();
        for region in regions {
            let factor = domain(region, left, folder)?;
            left = left.get(factor.dim()..).unwrap_or_default();
            factors.push(factor);
        }
        Ok(Self { factors })
    }

    /// The box around it: lower and upper corner.
    pub(crate) fn bounds(&self) -> (Vec<f64>, Vec<f64>) {
        let (low, high): (Vec<_>, Vec<_>) = self.factors.iter().map(Domain::bounds).unzip();
        (low.concat(), high.concat())
    }

    /// Whether a point lies inside.
    pub(crate) fn contains(&self, point: &[f64]) -> bool {
        let mut rest = point;
        self.factors.iter().all(|factor| {
            let (own, others) = rest.split_at(factor.dim());
            rest = others;
            factor.contains(own)
        })
    }

    /// The edge over the first two coordinates, for pictures; empty if these are of two regions.
    pub(crate) fn outline(&self) -> Vec<[f64; 2]> {
        self.factors.first().map_or_else(Vec::new, |first| first.outline(200))
    }

    /// So many points of one of its portions.
    pub(crate) fn sample(&self, portion: Portion, count: usize) -> Placed {
        match portion {
            Portion::Inside => {
                let last = self.layer(count);
                let mut points = weighted(inside(&self.factors, count - last), &self.factors);
                if last > 0 {
                    let end = self.end(last, true).points;
                    // The weights of the others add up to the whole.
                    points.weights.extend(vec![0.0; end.weights.len()]);
                    points.coordinates.extend(end.coordinates);
                }
                Placed { points, normals: Vec::new() }
            }
            Portion::Boundary => self.boundary(count),
            Portion::Start => self.end(count, false),
            Portion::End => self.end(count, true),
        }
    }

    /// About how many points a group has that says nothing of it.
    pub(crate) fn usual(&self, portion: Portion, order: usize) -> usize {
        let dimensions = self.factors.iter().map(Domain::dim).sum::<usize>();
        let last = self.factors.last().map_or(0, Domain::dim);
        let of_edge =
            |dimensions: usize| if dimensions == 1 { EDGE * count(1, order) } else { count(dimensions, order) };
        match portion {
            Portion::Inside => count(dimensions, order),
            Portion::Boundary => of_edge(dimensions.saturating_sub(1)),
            Portion::Start | Portion::End => of_edge(dimensions - last),
        }
    }

    /// How many of so many points within lie where the last of several regions, an interval, ends. No condition holds there, so that
    /// without these points a strip before the end would be free.
    fn layer(&self, count: usize) -> usize {
        let dimensions = self.factors.iter().map(Domain::dim).sum::<usize>() as f64;
        match self.factors.last() {
            Some(last) if last.dim() == 1 && self.factors.len() > 1 => {
                (count as f64).powf((dimensions - 1.0) / dimensions) as usize
            }
            _ => 0,
        }
    }

    /// The edge of the first region, over all of the others.
    fn boundary(&self, count: usize) -> Placed {
        let Some((first, others)) = self.factors.split_first() else { return Placed::default() };
        let edge = first.boundary(count);
        let rest = inside(others, count.div_ceil(if first.dim() == 1 { edge.len() } else { 1 }));
        // Both ends of an interval meet all points of the others; along an edge, neighbours meet points that are far apart.
        let pairs: Vec<(usize, usize)> = match (others.is_empty(), first.dim()) {
            (true, _) => (0..edge.len()).map(|site| (site, 0)).collect(),
            (false, 1) => (0..rest.len()).flat_map(|at| [(0, at), (1, at)]).collect(),
            (false, _) => (0..rest.len()).map(|at| (at * coprime(edge.len()) % edge.len(), at)).collect(),
        };
        let size = first.boundary_measure() * others.iter().map(Domain::measure).product::<f64>();
        let mut placed = Placed { points: Points::default(), normals: vec![Vec::new(); first.dim()] };
        for &(site, at) in &pairs {
            placed.points.coordinates.extend(&edge.coords[site * first.dim()..(site + 1) * first.dim()]);
            placed.points.coordinates.extend(&rest[at]);
            placed.points.weights.push(size / pairs.len() as f64);
            let normal = edge.normal(site).unwrap_or_default();
            placed.normals.iter_mut().zip(normal).for_each(|(entries, entry)| entries.push(*entry));
        }
        placed
    }

    /// Where the last region, an interval, begins or ends.
    fn end(&self, count: usize, last: bool) -> Placed {
        let Some((interval, others)) = self.factors.split_last() else { return Placed::default() };
        let (low, high) = interval.bounds();
        let value = if last { high[0] } else { low[0] };
        let mut sites = inside(others, count);
        sites.iter_mut().for_each(|site| site.push(value));
        Placed { points: weighted(sites, others), normals: Vec::new() }
    }
}

/// A region as declared over the first of these coordinates.
fn domain(region: &Region, coordinates: &[Coordinate], folder: &Path) -> Result<Domain, DataError> {
    let part = |region: &Region| domain(region, coordinates, folder);
    match region {
        Region::Box(ranges) => {
            let (low, high): (Vec<f64>, Vec<f64>) = ranges.iter().map(|[low, high]| (*low, *high)).unzip();
            Domain::cuboid(&low, &high)
        }
        Region::Ellipse { centre, semi_axes } => Domain::ellipse(*centre, *semi_axes),
        Region::Polygon(corners) => Domain::polygon(corners),
        Region::Ball { centre, radius } => Domain::ball(*centre, *radius),
        Region::Cylinder { centre, radius, ends } => Domain::cylinder(*centre, *radius, *ends),
        Region::File { kind: FileKind::Polygon, path, .. } => {
            let table = Table::read(folder.join(path))?;
            let columns = coordinates.iter().take(2).map(|axis| table.quantity(axis.name, axis.unit.text));
            let columns = columns.collect::<Result<Vec<_>, _>>()?;
            let corners: Vec<[f64; 2]> = (0..table.rows()).map(|row| [columns[0][row], columns[1][row]]).collect();
            Domain::polygon(&corners).map_err(|error| of_file(table.path(), &error))
        }
        Region::File { kind: FileKind::Solid, path, scale } => {
            let path = folder.join(path);
            Domain::solid(&Surface::read(&path)?, *scale).map_err(|error| of_file(&path, &error))
        }
        Region::Plus([a, b]) => part(a)?.plus(part(b)?),
        Region::Minus([a, b]) => part(a)?.minus(part(b)?),
    }
}

/// What is wrong with a region, said of the file that it was read from.
fn of_file(path: &Path, error: &DataError) -> DataError {
    DataError::File { path: path.into(), what: error.to_string() }
}

/// How many points a group shall have: as the user asks, as its equation says, or nothing if neither does.
pub(crate) fn asked(group: &Group, place: &Place, points: &[(String, usize)]) -> Option<usize> {
    let user = points.iter().rev().find(|(name, _)| name == group.name).map(|(_, count)| *count);
    user.or(place.points)
}

/// Points over a portion of so many dimensions, for equations of this order: splines of as many degrees more need as many more.
fn count(dimensions: usize, order: usize) -> usize {
    dimensions.checked_sub(1).map_or(1, |at| POINTS[at.min(POINTS.len() - 1)] * (order + 2).max(4) / 4)
}

/// Points that fill the product of regions evenly; one without coordinates where there are none.
fn inside(factors: &[Domain], count: usize) -> Vec<Vec<f64>> {
    match factors {
        [] => vec![Vec::new()],
        [one] => one.interior(count, Sampling::Sobol, 0).iter().map(<[f64]>::to_vec).collect(),
        _ => {
            let body = Body { factors: factors.to_vec() };
            let (low, high) = body.bounds();
            let around: f64 = low.iter().zip(&high).map(|(low, high)| high - low).product();
            let share = factors.iter().map(Domain::measure).product::<f64>() / around;
            // The regions were boxes of finite size, or within one.
            let Ok(around) = Domain::cuboid(&low, &high) else { return Vec::new() };
            let drawn = around.interior((count as f64 / share).ceil() as usize, Sampling::Sobol, 0);
            drawn.iter().filter(|point| body.contains(point)).map(<[f64]>::to_vec).collect()
        }
    }
}

/// Points with equal weights that add up to the size of the product of regions.
fn weighted(sites: Vec<Vec<f64>>, factors: &[Domain]) -> Points {
    let size: f64 = factors.iter().map(Domain::measure).product();
    Points { weights: vec![size / sites.len() as f64; sites.len()], coordinates: sites.concat(), ..Points::default() }
}

/// A stride by which all of `count` sites are visited, about a golden section of them.
fn coprime(count: usize) -> usize {
    let divides = |a: usize, b: usize| {
        let (mut a, mut b) = (a, b);
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a > 1
    };
    let near = (0.618 * count as f64) as usize;
    (near.max(1)..=count).find(|stride| !divides(*stride, count)).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SLAB: [Region; 2] =
        [Region::Ellipse { centre: [1.0, 0.0], semi_axes: [2.0, 2.0] }, Region::Box(&[[0.0, 5.0]])];

    fn built(regions: &[Region]) -> Body {
        Body::new(regions, &[], Path::new("")).unwrap()
    }

    fn size(placed: &Placed) -> f64 {
        placed.points.weights.iter().sum()
    }

    #[test]
    fn weights_are_the_size_of_a_portion() {
        let body = built(&SLAB);
        let (area, edge) = (std::f64::consts::PI * 4.0, std::f64::consts::TAU * 2.0);
        let portions = [Portion::Inside, Portion::Boundary, Portion::Start, Portion::End];
        for (portion, exact) in portions.into_iter().zip([5.0 * area, 5.0 * edge, area, area]) {
            assert!((size(&body.sample(portion, body.usual(portion, 2))) / exact - 1.0).abs() < 1e-12, "{portion:?}");
        }
        let rod = built(&[Region::Box(&[[1.0, 4.0]])]);
        assert_eq!(rod.sample(Portion::Boundary, 2).points.coordinates, [1.0, 4.0]);
        assert_eq!(rod.sample(Portion::Boundary, 2).normals, [[-1.0, 1.0]]);
        assert_eq!(rod.sample(Portion::End, 1).points.coordinates, [4.0]);
    }

    #[test]
    fn points_lie_where_their_portion_is() {
        let body = built(&SLAB);
        let of = |portion: Portion| body.sample(portion, body.usual(portion, 2)).points.coordinates;
        for point in of(Portion::Inside).chunks(3) {
            assert!(body.contains(point));
        }
        let edge = body.sample(Portion::Boundary, 800);
        let angles: Vec<f64> = edge.points.coordinates.chunks(3).map(|p| p[1].atan2(p[0] - 1.0)).collect();
        for (at, point) in edge.points.coordinates.chunks(3).enumerate() {
            assert!(((point[0] - 1.0).hypot(point[1]) - 2.0).abs() < 1e-9 && (0.0..=5.0).contains(&point[2]));
            assert!((edge.normals[0][at] - angles[at].cos()).abs() < 1e-9);
        }
        // Early and late times are met all around the edge.
        for late in [false, true] {
            let met = edge.points.coordinates.chunks(3).zip(&angles).filter(|(point, _)| (point[2] > 2.5) == late);
            let mean = met.clone().map(|(_, angle)| angle.cos()).sum::<f64>() / met.count() as f64;
            assert!(mean.abs() < 0.05, "{mean}");
        }
        assert!(of(Portion::Start).chunks(3).all(|point| point[2] == 0.0));
        assert!(of(Portion::End).chunks(3).all(|point| point[2] == 5.0));
    }
}
