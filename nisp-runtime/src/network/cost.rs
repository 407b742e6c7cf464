//! What a point costs: floating-point operations of the network, from its shape and a group's channels.

use super::Architecture;
use crate::schema::{Group, RuleFlops};

/// Floating-point operations a point; a fused multiply-add counts two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cost {
    /// Matrix products of the hidden layers, over all channels.
    pub products: usize,
    /// Activations and gates of all layers, over all channels.
    pub rules: usize,
    /// Dot products of the heads, over the channels that are read of each.
    pub heads: usize,
}

impl Cost {
    /// Everything.
    pub fn total(&self) -> usize {
        self.products + self.rules + self.heads
    }
}

impl Architecture {
    /// What a point of a group costs from its coordinates to the heads' outputs, and what the way back costs. A partner
    /// costs as much again as its point, and so does a site at which coordinates are held.
    pub fn cost(&self, group: &Group) -> [Cost; 2] {
        let sites = group.sites();
        let mut outputs: Vec<(usize, usize)> =
            group.jets.iter().flat_map(|jet| jet.combination.iter().map(|&(channel, _)| (jet.head, channel))).collect();
        outputs.sort_unstable();
        outputs.dedup();
        // On the way back a product gives two: the adjoint of its input, and that of its weights.
        [(1, 0), (2, 1)].map(|(products, way)| {
            let RuleFlops { compose, affine, product } = group.rule_flops;
            let gated = if self.gates() > 0 { self.layers } else { 0 };
            let unit = (self.layers - 1) * compose[way] + (1 + self.gates()) * affine[way] + gated * product[way];
            Cost {
                products: products * sites * 2 * (self.layers - 1) * self.width * self.width * group.channels.len(),
                rules: sites * self.width * unit,
                heads: products * sites * 2 * self.width * outputs.len(),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::Jet;

    #[test]
    fn products_go_over_channels_and_heads_over_what_is_read() {
        let jet = |head, combination| Jet { head, name: "", degree: &[], combination, operator: &[], site: 0 };
        let jets = [jet(0, &[(0, 1.0)]), jet(0, &[(3, 2.0), (0, 1.0)]), jet(1, &[(0, 1.0)])];
        let group = Group {
            name: "",
            docs: "",
            channels: &["1", "x", "y", "xx + yy"],
            order: 2,
            dense: 6,
            jets: jets.to_vec().leak(),
            columns: &[],
            terms: &[],
            rows: 1,
            place: None,
            paired: false,
            held: &[],
            flops: [0, 0],
            rule_flops: RuleFlops { compose: [11, 23], affine: [5, 7], product: [2, 3] },
        };
        let [forward, back] = Architecture::modified(10, 3).cost(&group);
        // Two hidden layers of ten by ten over four channels; three outputs; two compositions, three affine maps, three gated
        // layers of ten units.
        assert_eq!(forward, Cost { products: 2 * 4 * 200, rules: 10 * (2 * 11 + 3 * 5 + 3 * 2), heads: 3 * 20 });
        assert_eq!(back, Cost { products: 4 * 4 * 200, rules: 10 * (2 * 23 + 3 * 7 + 3 * 3), heads: 6 * 20 });
        let [plain, _] = Architecture::plain(10, 1).cost(&Group { paired: true, ..group });
        assert_eq!(plain, Cost { products: 0, rules: 2 * 10 * 5, heads: 2 * 3 * 20 });
    }
}
