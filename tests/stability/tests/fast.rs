//! The fast part of the suite.

use nisp_stability::{Extent, ITEMS};

fn holds(name: &str) {
    let item = ITEMS.iter().find(|item| item.name == name).expect("an item");
    let rows = (item.run)(Extent::Fast);
    assert!(!rows.is_empty());
    let bad: Vec<_> = rows.iter().filter(|row| !row.holds()).collect();
    assert!(bad.is_empty(), "{bad:#?}");
}

macro_rules! items {
    ($($name:ident)*) => {
        $(#[test]
        fn $name() {
            holds(stringify!($name));
        })*

        #[test]
        fn every_item_is_tested() {
            assert_eq!(ITEMS.map(|item| item.name), [$(stringify!($name)),*]);
        }
    };
}

items! { tanh channels adjoints invariance saturation scaling precision degenerate limits faults determinism soak }
