//! Points of declared domains: products of regions over the coordinates in their order.

use nisp::Points;
use nisp::schema::{Portion, Region};
use nisp_data::DataError;
use nisp_data::domain::{Domain, Sampling};

/// Points on a line, over an area and in a volume, or in more dimensions.
const POINTS: [usize; 3] = [160, 800, 2000];

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
    /// A domain as declared.
    ///
    /// # Errors
    /// A polygon that crosses itself.
    pub(crate) fn new(regions: &[Region]) -> Result<Self, DataError> {
        let factors = regions.iter().map(|region| match region {
            Region::Box(ranges) => {
                let (low, high): (Vec<f64>, Vec<f64>) = ranges.iter().map(|[low, high]| (*low, *high)).unzip();
                Domain::cuboid(&low, &high)
            }
            Region::Ellipse { centre, semi_axes } => Domain::ellipse(*centre, *semi_axes),
            Region::Polygon(corners) => Domain::polygon(corners),
        });
        Ok(Self { factors: factors.collect::<Result<_, _>>()? })
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

    /// Points of one of its portions.
    pub(crate) fn sample(&self, portion: Portion) -> Placed {
        match portion {
            Portion::Inside => {
                let dimensions = self.factors.iter().map(Domain::dim).sum();
                let sites = inside(&self.factors, count(dimensions));
                Placed { points: weighted(sites, &self.factors), normals: Vec::new() }
            }
            Portion::Boundary => self.boundary(),
            Portion::Start => self.end(false),
            Portion::End => self.end(true),
        }
    }

    /// The edge of the first region, over all of the others.
    fn boundary(&self) -> Placed {
        let Some((first, others)) = self.factors.split_first() else { return Placed::default() };
        let dimensions = self.factors.iter().map(Domain::dim).sum::<usize>() - 1;
        let edge = first.boundary(count(dimensions));
        let rest = inside(others, count(dimensions).div_ceil(if first.dim() == 1 { edge.len() } else { 1 }));
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
    fn end(&self, last: bool) -> Placed {
        let Some((interval, others)) = self.factors.split_last() else { return Placed::default() };
        let (low, high) = interval.bounds();
        let value = if last { high[0] } else { low[0] };
        let mut sites = inside(others, count(others.iter().map(Domain::dim).sum()));
        sites.iter_mut().for_each(|site| site.push(value));
        Placed { points: weighted(sites, others), normals: Vec::new() }
    }
}

/// Points over a portion of so many dimensions.
fn count(dimensions: usize) -> usize {
    dimensions.checked_sub(1).map_or(1, |at| POINTS[at.min(POINTS.len() - 1)])
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

    fn size(placed: &Placed) -> f64 {
        placed.points.weights.iter().sum()
    }

    #[test]
    fn weights_are_the_size_of_a_portion() {
        let body = Body::new(&SLAB).unwrap();
        let (area, edge) = (std::f64::consts::PI * 4.0, std::f64::consts::TAU * 2.0);
        let portions = [Portion::Inside, Portion::Boundary, Portion::Start, Portion::End];
        for (portion, exact) in portions.into_iter().zip([5.0 * area, 5.0 * edge, area, area]) {
            assert!((size(&body.sample(portion)) / exact - 1.0).abs() < 1e-12, "{portion:?}");
        }
        let rod = Body::new(&[Region::Box(&[[1.0, 4.0]])]).unwrap();
        assert_eq!(rod.sample(Portion::Boundary).points.coordinates, [1.0, 4.0]);
        assert_eq!(rod.sample(Portion::Boundary).normals, [[-1.0, 1.0]]);
        assert_eq!(rod.sample(Portion::End).points.coordinates, [4.0]);
    }

    #[test]
    fn points_lie_where_their_portion_is() {
        let body = Body::new(&SLAB).unwrap();
        let of = |portion: Portion| body.sample(portion).points.coordinates;
        for point in of(Portion::Inside).chunks(3) {
            assert!(body.contains(point));
        }
        let edge = body.sample(Portion::Boundary);
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
