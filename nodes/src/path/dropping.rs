//! What the nodes that drop a cutter share.

use carvegraph_core::{Context, NodeError};
use carvegraph_geometry::{ContactKind, Cutter, DropCutter, DropError, Pattern, Surface, Toolpath};

/// Lowers the cutter at every point of a pattern, but leaves an allowance; tells at how many points it
/// fell to the floor.
pub(super) fn dropped(
    surface: Surface<'_>,
    cutter: &Cutter,
    pattern: &Pattern,
    (allowance_mm, floor_mm): (f64, f64),
    cx: &Context<'_>,
) -> Result<Toolpath, NodeError> {
    let ticker = cx.ticker(pattern.points.len());
    let tick = |count| ticker.tick(count);
    let ready = DropCutter::new(surface, &cutter.profile, allowance_mm, &tick).map_err(fault)?;
    let path = cx.completed(ready.path(pattern, floor_mm, &tick))?;
    let missed = path.contacts.iter().filter(|c| c.kind == ContactKind::None).count();
    if missed > 0 {
        cx.warn(format!("at {missed} points nothing is under the cutter: floor, {floor_mm} mm"));
    }
    Ok(path)
}

/// What a node says when the cutter cannot be dropped.
fn fault(fault: DropError) -> NodeError {
    match fault {
        DropError::Stopped => NodeError::Cancelled,
        fault => NodeError::failed(fault),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_geometry::{Against, DVec2, HeightField, PatternSpan, Profile};

    #[test]
    fn an_allowance_is_left_under_the_tip_but_not_beside_the_surface() {
        let field = HeightField::new(5, 5, 1.0, vec![2.0; 25]).unwrap();
        let cutter = Cutter { name: "flat".into(), profile: Profile::flat(1.0).unwrap() };
        let spans = vec![PatternSpan { points: 0..2, link: false, joined: false }];
        let pattern = Pattern { points: vec![DVec2::splat(2.0), DVec2::splat(9.0)], spans };
        let surface = Surface::Field(&field, Against::Mesh);
        let path = run(|cx| dropped(surface, &cutter, &pattern, (0.25, -1.0), cx)).unwrap();
        assert_eq!((path.tips[0].z, path.tips[1].z), (2.25, -1.0));
        let bad = run(|cx| dropped(surface, &cutter, &pattern, (-1.0, 0.0), cx)).unwrap_err();
        assert!(
            bad.to_string().contains("allowance must be a positive length, not -1 mm"),
            "{bad}"
        );
    }
}
