//! What the nodes that drop a cutter share.

use super::pattern::MAX_POINTS;
use carvegraph_core::{Context, NodeError, Params, Yielding};
use carvegraph_geometry::{ContactKind, Cutter, DropCutter, DropError, Pattern, Surface, Toolpath};

/// Where the tip of a dropped cutter may be.
#[derive(Clone, Debug, Params)]
pub(crate) struct Tip {
    /// The tip goes no lower, and is there where nothing lies under the cutter. If it is not set, that is
    /// the lowest place of the surface.
    #[param(unit = "mm", default = 0.0, range = -100_000.0..=100_000.0)]
    pub(crate) floor: Yielding<f64>,
    /// What is left on the surface: no point of the cutter comes closer.
    #[param(unit = "mm", default = 0.0, range = 0.0..=50.0)]
    pub(crate) allowance: f64,
    /// How far the cutter may be off between two points: where the path bends by more, points are put in.
    /// 0 puts in none.
    #[param(unit = "mm", default = 0.01, range = 0.0..=10.0)]
    pub(crate) chord_tolerance: f64,
}

/// Lowers the cutter at every point of a pattern, and between them where the path bends. Tells at how
/// many points of the pattern nothing is under the cutter.
///
/// Beside the rim of a part the cutter touches it sideways, with its tip up to its radius below: without
/// the floor it would cut into what the part lies on.
pub(super) fn dropped(
    surface: Surface<'_>,
    cutter: &Cutter,
    pattern: &Pattern,
    tip: &Tip,
    cx: &Context<'_>,
) -> Result<Toolpath, NodeError> {
    let bends = tip.chord_tolerance > 0.0;
    let ticker = cx.ticker(pattern.points.len() * if bends { 2 } else { 1 });
    let tick = |count| ticker.tick(count);
    let ready = DropCutter::new(surface, &cutter.profile, tip.allowance, &tick).map_err(fault)?;
    let floor_mm = tip.floor.or(surface.bounds().map(|bounds| bounds.min.z));
    let mut path = cx.completed(ready.path(pattern, floor_mm, &tick))?;
    let missed = path.contacts.iter().filter(|c| c.kind == ContactKind::None).count();
    if missed > 0 {
        cx.warn(format!("at {missed} points nothing is under the cutter: floor, {floor_mm} mm"));
    }
    path.raise(floor_mm);
    if !bends {
        return Ok(path);
    }
    let most = MAX_POINTS as usize;
    let bent = ready.bend(&path, floor_mm, tip.chord_tolerance, most, &tick).map_err(fault)?;
    cx.note(format!("{} points put in where the path bends", bent.tips.len() - path.tips.len()));
    Ok(bent)
}

/// What a node says when the cutter cannot be dropped.
pub(super) fn fault(fault: DropError) -> NodeError {
    match fault {
        DropError::Stopped => NodeError::Cancelled,
        DropError::TooManyBends(_) => NodeError::refused("chord_tolerance", fault.to_string()),
        fault => NodeError::failed(fault),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_geometry::{Against, DVec2, HeightField, PatternSpan, Profile};

    fn tip(floor: Yielding<f64>) -> Tip {
        Tip { floor, allowance: 0.0, chord_tolerance: 0.0 }
    }

    #[test]
    fn an_allowance_is_left_under_the_tip_but_not_beside_the_surface() {
        let field = HeightField::new(5, 5, 1.0, vec![2.0; 25]).unwrap();
        let cutter = Cutter { name: "flat".into(), profile: Profile::flat(1.0).unwrap() };
        let spans = vec![PatternSpan { points: 0..2, link: false, joined: false }];
        let pattern = Pattern { points: vec![DVec2::splat(2.0), DVec2::splat(9.0)], spans };
        let surface = Surface::Field(&field, Against::Mesh);
        let tip = |allowance| Tip { allowance, ..tip(Yielding::given(-1.0)) };
        let path = run(|cx| dropped(surface, &cutter, &pattern, &tip(0.25), cx)).unwrap();
        assert_eq!((path.tips[0].z, path.tips[1].z), (2.25, -1.0));
        let bad = run(|cx| dropped(surface, &cutter, &pattern, &tip(-1.0), cx)).unwrap_err();
        assert!(
            bad.to_string().contains("allowance must be a positive length, not -1 mm"),
            "{bad}"
        );
    }

    #[test]
    fn beside_a_rim_the_tip_does_not_sink_below_the_part() {
        let field = HeightField::new(2, 2, 1.0, vec![2.0; 4]).unwrap();
        let cutter = Cutter { name: "ball".into(), profile: Profile::ball(3.0).unwrap() };
        let spans = vec![PatternSpan { points: 0..2, link: false, joined: false }];
        let pattern = Pattern { points: vec![DVec2::new(0.5, 0.5), DVec2::new(3.9, 0.5)], spans };
        let surface = Surface::Field(&field, Against::Mesh);
        let tips = |floor| {
            let path = run(|cx| dropped(surface, &cutter, &pattern, &tip(floor), cx)).unwrap();
            [path.tips[0].z, path.tips[1].z]
        };
        assert_eq!(tips(Yielding::left(0.0)), [2.0, 2.0]);
        assert_eq!(tips(Yielding::given(1.0)), [2.0, 1.0]);
        let [_, free] = tips(Yielding::given(-9.0));
        // 2.9 mm beside the rim.
        assert!((free - (2.0 - 3.0 + (9.0_f64 - 2.9 * 2.9).sqrt())).abs() < 1e-9, "{free}");
    }
}
