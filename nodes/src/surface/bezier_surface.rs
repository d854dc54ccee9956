//! Bézier patches as parts.
//!
//! The two test parts of Sood, *Novel algorithms for CAD-free machining* (thesis, 2015), chapter 5, or a net
//! of control points of one's own. See [`carvegraph_geometry::BezierPatch`].
//!
//! A net is a text: each line that is not empty is a row of the net, of three numbers a point: x, y and z in
//! mm. Numbers stand apart by blanks, commas or semicolons; from # on a line is a remark.

use carvegraph_core::{Choice, Conflict, Context, InputFile, Node, NodeError, Outputs, Params};
use carvegraph_geometry::{BezierError, BezierPatch, Bounds, DVec3, Mesh};

/// A net has no more points: 32 × 32.
const MAX_NUMBERS: usize = 3 * 32 * 32;

/// Makes a closed part whose upper side is a Bézier patch over a net of control points.
#[derive(Clone, Debug, Params)]
pub(crate) struct BezierSurface {
    /// Which patch.
    #[param(default = TestPart::Bezier)]
    pub(crate) part: TestPart,
    /// Text file with the control points, where part is net: a row of the net on each line, x y z of each
    /// point in mm.
    #[param(default = None)]
    pub(crate) net: Option<InputFile>,
    /// Steps along each side; each cell is two triangles.
    #[param(default = 20, range = 1..=2000)]
    pub(crate) divisions: u32,
    /// Height of the part's underside.
    #[param(unit = "mm", default = 0.0, range = -100_000.0..=100_000.0)]
    pub(crate) base: f64,
}

/// A patch.
#[derive(Clone, Copy, Debug, PartialEq, Choice)]
pub(crate) enum TestPart {
    /// The source's test part, 50 × 100 × 25 mm, that rises from a corner.
    Bezier,
    /// The source's convex test part, 50 × 50 mm.
    Convex,
    /// A net of your own.
    Net,
}

#[derive(Outputs)]
pub(crate) struct Made {
    /// The part.
    mesh: Mesh,
    /// The box that holds it.
    bounds: Bounds,
}

impl Node for BezierSurface {
    const KIND: &'static str = "bezier_surface";
    type Inputs<'a> = ();
    type Outputs = Made;

    fn check(&self) -> Result<(), Conflict> {
        let message = match (self.part, &self.net) {
            (TestPart::Net, None) => "part is net, but there is no file with one",
            (TestPart::Bezier | TestPart::Convex, Some(_)) => {
                "a net is given, but part is not net: set it, or leave the net out"
            }
            _ => return Ok(()),
        };
        Err(Conflict { param: "net", message: message.to_owned() })
    }

    fn run(&self, (): (), cx: &Context<'_>) -> Result<Made, NodeError> {
        let patch = match (self.part, &self.net) {
            (TestPart::Bezier, _) => BezierPatch::rising(),
            (TestPart::Convex, _) => BezierPatch::convex(),
            (TestPart::Net, Some(file)) => read(file, cx)?,
            (TestPart::Net, None) => return Err(NodeError::failed("there is no net")),
        };
        let divisions = self.divisions as usize;
        let ticker = cx.ticker(divisions + 1);
        let mesh = patch.part(divisions, self.base, &|count| ticker.tick(count));
        let mesh = mesh.map_err(|fault| match fault {
            BezierError::Stopped => NodeError::Cancelled,
            BezierError::BaseTooHigh { .. } => NodeError::refused("base", fault.to_string()),
            fault => NodeError::failed(fault),
        })?;
        let bounds = mesh.bounds().ok_or_else(|| NodeError::failed("the part has no triangles"))?;
        cx.note(format!("{} triangles", mesh.triangles.len()));
        Ok(Made { mesh, bounds })
    }
}

fn read(file: &InputFile, cx: &Context<'_>) -> Result<BezierPatch, NodeError> {
    let bytes = cx.read(file)?;
    let text = std::str::from_utf8(&bytes)
        .map_err(|_| NodeError::Failed(format!("{file} is no text: a net is rows of numbers")))?;
    let rows = rows(text).map_err(|fault| NodeError::Failed(format!("{file} {fault}")))?;
    BezierPatch::new(&rows).map_err(|fault| NodeError::Failed(format!("{file}: {fault}")))
}

/// The rows of a net; a fault says its line.
fn rows(text: &str) -> Result<Vec<Vec<DVec3>>, String> {
    let (mut rows, mut count, mut first): (Vec<Vec<DVec3>>, _, _) = (Vec::new(), 0, 0);
    for (k, line) in text.lines().enumerate() {
        let k = k + 1;
        let line = line.split('#').next().unwrap_or_default();
        let words = line.split(|c: char| c.is_whitespace() || c == ',' || c == ';');
        let mut numbers = Vec::new();
        for word in words.filter(|word| !word.is_empty()) {
            let number = word.parse().ok().filter(|number: &f64| number.is_finite());
            let shown: String = word.chars().take(30).collect();
            numbers.push(number.ok_or_else(|| format!("line {k}: {shown:?} is no finite number"))?);
            count += 1;
            if count > MAX_NUMBERS {
                return Err(format!("line {k}: more than {MAX_NUMBERS} numbers, 32 × 32 points"));
            }
        }
        if numbers.is_empty() {
            continue;
        }
        if numbers.len() % 3 != 0 {
            let given = numbers.len();
            return Err(format!("line {k}: {given} numbers make no points of x, y and z"));
        }
        let row: Vec<DVec3> = numbers.chunks(3).map(DVec3::from_slice).collect();
        if let Some(longer) = rows.first().filter(|known| known.len() != row.len()) {
            let (given, known) = (row.len(), longer.len());
            return Err(format!("line {k}: {given} points, but line {first} has {known}"));
        }
        if rows.is_empty() {
            first = k;
        }
        rows.push(row);
    }
    if rows.is_empty() { Err("holds no points".to_owned()) } else { Ok(rows) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::run;
    use carvegraph_core::Origin;

    const NODE: BezierSurface =
        BezierSurface { part: TestPart::Bezier, net: None, divisions: 20, base: 0.0 };

    fn of_net(text: &str) -> Result<Made, String> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("net.txt"), text).unwrap();
        let net = Some(Origin::Folder(folder.path().to_owned()).locate("net.txt"));
        let node = BezierSurface { part: TestPart::Net, net, ..NODE };
        node.check().unwrap();
        run(|cx| node.run((), cx)).map_err(|fault| fault.to_string())
    }

    #[test]
    fn the_test_parts_have_the_triangles_and_sizes_of_the_source() {
        for (part, divisions, count, y, z) in [
            (TestPart::Bezier, 20, 886, 100.0, 25.0),
            (TestPart::Bezier, 40, 3366, 100.0, 25.0),
            (TestPart::Convex, 20, 886, 50.0, 20.5),
        ] {
            let made = run(|cx| BezierSurface { part, divisions, ..NODE }.run((), cx)).unwrap();
            assert_eq!(made.mesh.triangles.len(), count);
            assert_eq!(made.bounds.size(), DVec3::new(50.0, y, z));
        }
    }

    #[test]
    fn a_net_of_ones_own_may_have_any_degree_and_remarks() {
        let made = of_net(
            "# two by four\n0 0 5, 0 1 6, 0 2 6, 0 3 5\n\n4 0 5; 4,1,6; 4 2 6; 4 3 5 # end\n",
        );
        let size = made.unwrap().bounds.size();
        assert!(size.distance(DVec3::new(4.0, 3.0, 5.75)) < 1e-12, "{size}");
    }

    #[test]
    fn faults_of_a_net_say_their_line() {
        for (text, told) in [
            ("0 0 1  0 1 1\n1 0 1  1 1 x\n", "net.txt line 2: \"x\" is no finite number"),
            ("0 0 1  0 1 inf\n", "line 1: \"inf\" is no finite number"),
            ("0 0 1  0 1\n", "line 1: 5 numbers make no points of x, y and z"),
            ("\n0 0 1  0 1 1\n1 0 1\n", "line 3: 1 points, but line 2 has 2"),
            ("# nothing\n", "net.txt holds no points"),
            ("0 0 1  0 1 1\n", "a net has 2 to 32 rows and columns; this one has 1 × 2"),
            (&"1 ".repeat(4000), "line 1: more than 3072 numbers"),
            ("0 0 1  0 1 1\n1 0 0  1 1 1\n", "the base at 0 mm must lie below the surface"),
        ] {
            let fault = of_net(text).map(|_| ()).unwrap_err();
            assert!(fault.contains(told), "{fault}");
        }
    }

    #[test]
    fn a_net_and_a_test_part_contradict_each_other() {
        let no_net = BezierSurface { part: TestPart::Net, ..NODE };
        assert_eq!(no_net.check().unwrap_err().param, "net");
        let net = Some(Origin::Folder("/".into()).locate("net.txt"));
        assert!(BezierSurface { net, ..NODE }.check().unwrap_err().message.contains("not net"));
    }
}
