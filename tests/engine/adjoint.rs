//! The adjoint is the transpose of the derivative: `u . (J v) = (J^T u) . v`.

use nisp_references::adjoint::dot_product_error;
use nisp_references::each_model;
use nisp_references::reference::Model;

#[test]
fn dot_products_with_tangents_and_adjoints_agree() {
    fn check<M: Model>(model: &M) {
        let error = dot_product_error(model);
        assert!(error <= 1e-13, "{}: {error:e}", model.scene().schema.module);
    }
    each_model!(check);
}
