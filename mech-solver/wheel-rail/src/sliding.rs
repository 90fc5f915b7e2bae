//! A patch that slides everywhere: the traction f p opposes the rigid slip, and there is no elastic
//! slip.

use super::local::Window;
use half_space::difference::Difference;
use half_space::tangential::{Creepage, ElementState, TangentialState};

/// Tractions under a bound [Pa], and the slip per step of one element, for these creepages and an
/// additional slip [m].
pub(super) fn everywhere(
    bound: &[f64],
    window: &Window,
    difference: Difference,
    [xi, eta, phi]: Creepage,
    more: Option<[&[f64]; 2]>,
) -> TangentialState {
    let [nx, _] = window.counts();
    let [dx, _] = window.sides;
    let mut state = TangentialState::at_rest(bound, [xi, eta, phi]);
    for (at, bound) in bound.iter().enumerate() {
        let x = window.along(0, at % nx) + difference.rigid_slip_ahead() * dx;
        let y = window.along(1, at / nx);
        let off_plane = more.map_or([0.0; 2], |more| more.map(|slip| slip[at]));
        let slip = [dx * (xi - phi * y) + off_plane[0], dx * (eta + phi * x) + off_plane[1]];
        let size = slip[0].hypot(slip[1]);
        for (component, slip) in slip.into_iter().enumerate() {
            state.slip[component][at] = slip;
            state.traction[component][at] = if size > 0.0 { -bound * slip / size } else { 0.0 };
        }
        if *bound > 0.0 && size > 0.0 {
            state.element[at] = ElementState::Slip;
        }
    }
    state
}
