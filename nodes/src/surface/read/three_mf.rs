//! 3MF (3MF Consortium, *Core Specification 1.3*, 2021, and the paths of the *Production Extension*).
//!
//! A zip archive of XML parts. `_rels/.rels` names the model; its `build` lists items, each an object
//! under a transform; an object is a mesh, or components: objects under transforms again, perhaps of
//! another part. All items together are the mesh, in the unit that the model names. Colours, slices,
//! lattices and what else extensions add are passed over.
//!
//! The parts are read as a stream (`quick-xml` over `zip`), so that memory follows the triangles and
//! not the XML, which takes ten times as much.

use super::text::{number, quoted};
use super::{MAX_POINTS, MAX_TRIANGLES, ReadError, ReadMesh, go_on, limited};
use carvegraph_geometry::{DAffine3, DVec3, Tick};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::collections::HashMap;
use std::io::{self, BufRead, BufReader, Cursor, Read};
use zip::ZipArchive;

const NAME: &str = "3MF";

/// Where the model is if nothing names it.
const USUAL_PART: &str = "3D/3dmodel.model";

/// Components may be nested this deep; real ones are three deep.
const MAX_DEPTH: usize = 32;

/// No build puts more objects in place: components of components multiply.
const MAX_PLACED: usize = 1_000_000;

/// No XML tag is longer. Those of models have some 100 bytes.
const MAX_TAG_BYTES: usize = 1 << 20;

/// An object's part and number.
type Id = (String, String);

/// An object, or what it is made of, in its place.
#[derive(Clone, Debug)]
struct Placed {
    id: Id,
    frame: DAffine3,
}

#[derive(Debug, Default)]
struct Object {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    components: Vec<Placed>,
}

/// All that was read of the archive.
#[derive(Default)]
struct Model {
    unit_mm: Option<f64>,
    objects: HashMap<Id, Object>,
    items: Vec<Placed>,
    /// Vertices and triangles of all objects.
    vertices: usize,
    triangles: usize,
}

/// Whether a file begins like a zip archive.
pub(super) fn is_zip(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04")
}

fn fault(part: &str, what: impl Into<String>) -> ReadError {
    ReadError::in_part(NAME, format!("part {}", quoted(part.as_bytes())), what)
}

/// Reads all items of the build.
pub(super) fn read_mesh(bytes: &[u8], tick: Tick<'_>) -> Result<ReadMesh, ReadError> {
    let damaged = |what: zip::result::ZipError| {
        ReadError::in_part(NAME, "the archive", format!("it is damaged or cut short: {what}"))
    };
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(damaged)?;
    let root = root_part(&mut archive)?;
    let mut model = Model::default();
    let mut waiting = vec![root.clone()];
    let mut seen = waiting.clone();
    while let Some(part) = waiting.pop() {
        read_part(&mut archive, &part, part == root, &mut model, tick)?;
        let named = model.objects.values().flat_map(|object| &object.components);
        let named: Vec<&String> = named.chain(&model.items).map(|placed| &placed.id.0).collect();
        for part in named {
            if !seen.contains(part) {
                seen.push(part.clone());
                waiting.push(part.clone());
            }
        }
        waiting.sort_unstable();
    }
    build(model)
}

/// The part that the archive names as its model.
fn root_part(archive: &mut ZipArchive<Cursor<&[u8]>>) -> Result<String, ReadError> {
    const RELATIONS: &str = "_rels/.rels";
    let mut root = None;
    if archive.index_for_name(RELATIONS).is_some() {
        each_tag(archive, RELATIONS, &|_| true, |tag| {
            if let Tag::Open(tag) = tag
                && tag.local_name().as_ref() == "Relationship"
                && attribute(tag, "Type")?.is_some_and(|kind| kind.ends_with("/3dmodel"))
            {
                root = attribute(tag, "Target")?;
            }
            Ok(())
        })?;
    }
    let root = root.unwrap_or_else(|| USUAL_PART.to_owned());
    Ok(root.trim_start_matches('/').to_owned())
}

/// What begins or ends.
enum Tag<'a> {
    Open(&'a BytesStart<'a>),
    Close(&'a str),
}

/// Calls `take` for each tag of a part.
fn each_tag(
    archive: &mut ZipArchive<Cursor<&[u8]>>,
    part: &str,
    tick: Tick<'_>,
    mut take: impl FnMut(&Tag<'_>) -> Result<(), String>,
) -> Result<(), ReadError> {
    let source = archive.by_name(part).map_err(|what| match what {
        zip::result::ZipError::FileNotFound => fault(part, "it is named but not in the archive"),
        what => fault(part, what.to_string()),
    })?;
    let source = Rationed { inner: BufReader::new(source), left: MAX_TAG_BYTES };
    let mut reader = Reader::from_reader(source);
    let (mut buffer, mut told) = (Vec::new(), 0);
    loop {
        reader.get_mut().left = MAX_TAG_BYTES;
        let at = reader.buffer_position();
        let at_place = |what: String| fault(part, format!("byte {at}: {what}"));
        match reader.read_event_into(&mut buffer) {
            Ok(Event::Start(tag)) => take(&Tag::Open(&tag)).map_err(at_place)?,
            Ok(Event::Empty(tag)) => {
                take(&Tag::Open(&tag)).map_err(at_place)?;
                take(&Tag::Close(tag.name().as_ref())).map_err(at_place)?;
            }
            Ok(Event::End(tag)) => take(&Tag::Close(tag.name().as_ref())).map_err(at_place)?,
            Ok(Event::Eof) => return Ok(()),
            Ok(_) => {}
            Err(what) => return Err(at_place(what.to_string())),
        }
        buffer.clear();
        if at - told >= 1 << 20 {
            // XML packs to about a tenth.
            go_on(tick, (at - told) as usize / 10)?;
            told = at;
        }
    }
}

/// A source that gives no more than `left` bytes, and then an error. It bounds what the XML reader
/// gathers for one tag or text.
struct Rationed<R> {
    inner: BufReader<R>,
    left: usize,
}

impl<R: Read> Read for Rationed<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(buffer)?;
        self.consume(count);
        Ok(count)
    }
}

impl<R: Read> BufRead for Rationed<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.left == 0 {
            return Err(io::Error::other(format!("a tag of more than {MAX_TAG_BYTES} bytes")));
        }
        self.inner.fill_buf()
    }

    fn consume(&mut self, count: usize) {
        self.left = self.left.saturating_sub(count);
        self.inner.consume(count);
    }
}

fn attribute(tag: &BytesStart<'_>, name: &str) -> Result<Option<String>, String> {
    for attribute in tag.attributes() {
        let attribute = attribute.map_err(|what| what.to_string())?;
        if attribute.key.local_name().as_ref() == name {
            return Ok(Some(attribute.value.into_owned()));
        }
    }
    Ok(None)
}

/// The values of attributes that a tag must have, in one go.
fn attributes<const N: usize>(
    tag: &BytesStart<'_>,
    names: [&str; N],
    mut take: impl FnMut(usize, &str) -> Option<()>,
) -> Result<(), String> {
    let mut found = [false; N];
    for attribute in tag.attributes().with_checks(false) {
        let attribute = attribute.map_err(|what| what.to_string())?;
        let Some(place) = names.iter().position(|name| *name == attribute.key.as_ref()) else {
            continue;
        };
        take(place, &attribute.value).ok_or_else(|| {
            let value = quoted(attribute.value.as_bytes());
            format!("{}={value} is out of its range", names[place])
        })?;
        found[place] = true;
    }
    match found.iter().position(|found| !found) {
        None => Ok(()),
        Some(place) => Err(format!("attribute {} is missing", names[place])),
    }
}

fn read_part(
    archive: &mut ZipArchive<Cursor<&[u8]>>,
    part: &str,
    is_root: bool,
    model: &mut Model,
    tick: Tick<'_>,
) -> Result<(), ReadError> {
    let mut prefix = String::new();
    let mut open: Option<(String, Object)> = None;
    each_tag(archive, part, tick, |tag| match tag {
        Tag::Close(name) => {
            if is_core(name, &prefix) == Some("object")
                && let Some((id, object)) = open.take()
            {
                model.objects.insert((part.to_owned(), id), object);
            }
            Ok(())
        }
        Tag::Open(tag) => {
            if tag.local_name().as_ref() == "model" {
                prefix = tag.name().prefix().map(|p| p.as_ref().to_owned()).unwrap_or_default();
                if is_root {
                    model.unit_mm = Some(unit_mm(attribute(tag, "unit")?.as_deref())?);
                }
                return Ok(());
            }
            let name = tag.name();
            match is_core(name.as_ref(), &prefix) {
                Some("object") => {
                    let id = attribute(tag, "id")?.ok_or("an object has no id")?;
                    open = Some((id, Object::default()));
                }
                Some("item") if is_root => model.items.push(placed(tag, "objectid", part)?),
                Some(name) => {
                    if let Some((_, object)) = &mut open {
                        add(name, tag, object, model, part)?;
                    }
                }
                None => {}
            }
            Ok(())
        }
    })
}

/// The name of a tag without its prefix, if that is the one of the core's own tags.
fn is_core<'a>(name: &'a str, prefix: &str) -> Option<&'a str> {
    match name.split_once(':') {
        Some((before, core)) if before == prefix => Some(core),
        None if prefix.is_empty() => Some(name),
        _ => None,
    }
}

/// Adds what a tag inside of an object says.
fn add(
    name: &str,
    tag: &BytesStart<'_>,
    object: &mut Object,
    model: &mut Model,
    part: &str,
) -> Result<(), String> {
    match name {
        "vertex" => {
            let mut vertex = [0.0; 3];
            attributes(tag, ["x", "y", "z"], |place, word| {
                vertex[place] = number(word.as_bytes()).filter(|length| length.is_finite())?;
                Some(())
            })?;
            object.vertices.push(DVec3::from_array(vertex));
            model.vertices += 1;
            limited("vertices", model.vertices as u64, MAX_POINTS).map_err(|e| e.to_string())
        }
        "triangle" => {
            let mut triangle = [0; 3];
            let count = object.vertices.len() as u32;
            attributes(tag, ["v1", "v2", "v3"], |place, word| {
                let index: u32 = word.trim().parse().ok()?;
                triangle[place] = Some(index).filter(|index| *index < count)?;
                Some(())
            })?;
            object.triangles.push(triangle);
            model.triangles += 1;
            limited("triangles", model.triangles as u64, MAX_TRIANGLES).map_err(|e| e.to_string())
        }
        "component" => {
            object.components.push(placed(tag, "objectid", part)?);
            Ok(())
        }
        _ => Ok(()),
    }
}

/// An object that a component or an item names.
fn placed(tag: &BytesStart<'_>, id: &str, part: &str) -> Result<Placed, String> {
    let id = attribute(tag, id)?.ok_or("it names no objectid")?;
    let path = attribute(tag, "path")?;
    let path = path.map_or(part.to_owned(), |path| path.trim_start_matches('/').to_owned());
    let frame = attribute(tag, "transform")?.map_or(Ok(DAffine3::IDENTITY), |text| frame(&text))?;
    Ok(Placed { id: (path, id), frame })
}

/// A transform: the images of x, y and z, and the shift.
fn frame(text: &str) -> Result<DAffine3, String> {
    let numbers: Vec<f64> = text
        .split_ascii_whitespace()
        .filter_map(|word| number(word.as_bytes()).filter(|number| number.is_finite()))
        .collect();
    match <[f64; 12]>::try_from(numbers) {
        Ok(numbers) => Ok(DAffine3::from_cols_array(&numbers)),
        Err(_) => Err(format!("the transform {} is not 12 numbers", quoted(text.as_bytes()))),
    }
}

fn unit_mm(name: Option<&str>) -> Result<f64, String> {
    Ok(match name.unwrap_or("millimeter") {
        "micron" => 0.001,
        "millimeter" => 1.0,
        "centimeter" => 10.0,
        "inch" => 25.4,
        "foot" => 304.8,
        "meter" => 1000.0,
        other => return Err(format!("{} is no unit", quoted(other.as_bytes()))),
    })
}

/// Puts all items into one mesh.
fn build(model: Model) -> Result<ReadMesh, ReadError> {
    let mut mesh = ReadMesh { format: NAME, unit_mm: model.unit_mm, ..ReadMesh::default() };
    let mut put = 0;
    for item in &model.items {
        place(&model, item, DAffine3::IDENTITY, 0, &mut put, &mut mesh)?;
    }
    Ok(mesh)
}

fn place(
    model: &Model,
    placed: &Placed,
    outer: DAffine3,
    depth: usize,
    put: &mut usize,
    mesh: &mut ReadMesh,
) -> Result<(), ReadError> {
    *put += 1;
    limited("objects in its build", *put as u64, MAX_PLACED)?;
    let (part, id) = &placed.id;
    if depth > MAX_DEPTH {
        let what = format!("object {} is nested deeper than {MAX_DEPTH}", quoted(id.as_bytes()));
        return Err(fault(part, what));
    }
    let Some(object) = model.objects.get(&placed.id) else {
        return Err(fault(part, format!("there is no object {}", quoted(id.as_bytes()))));
    };
    let frame = outer * placed.frame;
    let first = mesh.vertices.len();
    limited("vertices", (first + object.vertices.len()) as u64, MAX_POINTS)?;
    limited("triangles", (mesh.triangles.len() + object.triangles.len()) as u64, MAX_TRIANGLES)?;
    let moved = object.vertices.iter().map(|vertex| frame.transform_point3(*vertex));
    mesh.vertices.extend(moved);
    if !mesh.vertices[first..].iter().all(|vertex| vertex.is_finite()) {
        return Err(fault(
            part,
            format!("a transform moves object {} out of all numbers", quoted(id.as_bytes())),
        ));
    }
    // A mirrored object is turned inside out, so its triangles are wound the other way.
    let is_mirrored = frame.matrix3.determinant() < 0.0;
    mesh.triangles.extend(object.triangles.iter().map(|triangle| {
        let [a, b, c] = triangle.map(|index| index + first as u32);
        if is_mirrored { [a, c, b] } else { [a, b, c] }
    }));
    for component in &object.components {
        self::place(model, component, frame, depth + 1, put, mesh)?;
    }
    Ok(())
}
