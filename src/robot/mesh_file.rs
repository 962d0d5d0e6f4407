//! Reads the files of meshes with the crate `mesh-loader`, which trusts them: counts are checked before it reserves memory for them,
//! and a panic because of an index becomes an error.

use std::{
    ffi::OsStr,
    io::{self, ErrorKind},
    path::Path,
};

use mesh_loader::{Loader, Scene};
use quick_xml::{
    Reader,
    events::{BytesStart, Event},
};

use crate::input::{self, MOST_MESH, guarded, shown};

/// The deepest level of an element of a COLLADA file: the crate calls itself for each.
const MOST_LEVELS: usize = 64;

/// The largest `offset` of an input of a COLLADA primitive: an index has a number for each.
const MOST_OFFSET: u64 = 64;

/// The scene of a mesh file.
///
/// # Errors
/// If it cannot be read, is of no known format, or is damaged.
pub(super) fn read(path: &Path) -> Result<Scene, String> {
    let of_reading = |error: io::Error| format!("failed to read: {error}");
    let mut bytes = input::bytes(path, MOST_MESH).map_err(of_reading)?;
    match path.extension().and_then(OsStr::to_str) {
        Some(stl) if stl.eq_ignore_ascii_case("stl") => set_binary_header(&mut bytes),
        Some("obj" | "OBJ") => {}
        extension if matches!(extension, Some("dae" | "DAE")) || begins_as_collada(&bytes) => {
            let text = input::text_of(bytes).map_err(of_reading)?;
            check_collada(&text)?;
            bytes = text.into_bytes();
        }
        _ => {}
    }
    // Materials of an OBJ file are in others that it names, maybe again and again. The crate leaves out what cannot be read.
    let mut left = MOST_MESH;
    let of_materials = |path: &Path| {
        let read = input::bytes(path, left);
        left = match &read {
            Ok(bytes) => left - bytes.len() as u64,
            Err(error) if error.kind() == ErrorKind::FileTooLarge => 0,
            Err(_) => left,
        };
        read
    };
    guarded(|| {
        let scene = Loader::<Vec<u8>>::default().load_from_slice_with_reader(&bytes, path, of_materials);
        scene.map_err(|error| error.to_string())
    })
}

/// True if the crate takes a file without a known extension for COLLADA.
fn begins_as_collada(bytes: &[u8]) -> bool {
    const NAME: &[u8] = b"<COLLADA";
    bytes.windows(NAME.len()).take(1024).any(|part| part == NAME)
}

/// Sets the header of a binary STL file to one that says that it is binary: some begin with `solid`, as text does.
fn set_binary_header(bytes: &mut [u8]) {
    const HEADER: usize = 80;
    const TRIANGLE: u64 = 50;
    let count = bytes.get(HEADER..HEADER + 4).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    let binary_length = count.map(|count| HEADER as u64 + 4 + TRIANGLE * u64::from(count));
    if binary_length == Some(bytes.len() as u64) {
        bytes[..HEADER].fill(b' ');
    }
}

/// Requires of a COLLADA file what the crate relies on. What is no XML is left to it.
///
/// # Errors
/// What was found in which line, and what was expected.
fn check_collada(text: &str) -> Result<(), String> {
    let mut reader = Reader::from_str(text);
    reader.config_mut().check_end_names = false;
    let mut open: Vec<Vec<u8>> = Vec::new();
    loop {
        let event = reader.read_event();
        let place = (reader.buffer_position() as usize).min(text.len());
        let at = |problem: String| {
            let line = 1 + text.as_bytes()[..place].iter().filter(|&&byte| byte == b'\n').count();
            format!("line {line}: {problem}")
        };
        match event {
            Ok(Event::Start(element)) => {
                check_element(&element, &open, text.len()).map_err(at)?;
                open.push(element.local_name().as_ref().to_vec());
                if open.len() > MOST_LEVELS {
                    return Err(at(format!(
                        "found elements nested {} deep, expected at most {MOST_LEVELS}",
                        open.len()
                    )));
                }
            }
            Ok(Event::Empty(element)) => check_element(&element, &open, text.len()).map_err(at)?,
            Ok(Event::End(_)) => drop(open.pop()),
            Ok(Event::Text(numbers)) if open.last().is_some_and(|name| name == b"vcount") => {
                check_corners(&numbers, text.len()).map_err(at)?;
            }
            Ok(Event::Eof) | Err(_) => return Ok(()),
            Ok(_) => {}
        }
    }
}

/// Requires counts that the file can have.
fn check_element(element: &BytesStart<'_>, open: &[Vec<u8>], length: usize) -> Result<(), String> {
    let name = element.local_name();
    let name = String::from_utf8_lossy(name.as_ref());
    // The crate would not end.
    let is_of_names = matches!(&*name, "Name_array" | "IDREF_array");
    if is_of_names && open.iter().any(|name| name == b"library_geometries") {
        return Err(format!("found <{name}> in a geometry, expected <float_array>"));
    }
    for attribute in element.attributes().flatten() {
        let most = match attribute.key.as_ref() {
            b"count" | b"stride" => length as u64,
            b"offset" => MOST_OFFSET,
            _ => continue,
        };
        let value = String::from_utf8_lossy(&attribute.value);
        // What is no number is left to the crate.
        if value.trim().parse::<u64>().is_ok_and(|count| count > most) {
            let key = String::from_utf8_lossy(attribute.key.as_ref());
            return Err(format!("found {key} {} of <{name}>, expected at most {most}", shown(&value)));
        }
    }
    Ok(())
}

/// Requires polygons with no more corners than the file has bytes.
fn check_corners(numbers: &[u8], length: usize) -> Result<(), String> {
    let numbers = String::from_utf8_lossy(numbers);
    let counts = numbers.split_ascii_whitespace().filter_map(|count| count.parse::<u64>().ok());
    let sum = counts.fold(0, u64::saturating_add);
    if sum > length as u64 {
        return Err(format!("found polygons with {sum} corners, expected at most {length}"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::robot::geometry::MeshFile;

    fn problem(name: &str, bytes: &[u8]) -> String {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        read(&path).err().unwrap()
    }

    /// A triangle in COLLADA with this count of numbers, in an array with this name, and these indexes.
    fn collada(array: &str, count: &str, primitive: &str) -> String {
        format!(
            "<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">\n<library_geometries>\
             <geometry id=\"g\"><mesh>\n<source id=\"p\"><{array} id=\"pa\" count=\"{count}\">0 0 0 1 0 0 0 1 0</{array}>\
             <technique_common><accessor source=\"#pa\" count=\"3\" stride=\"3\"><param name=\"X\" type=\"float\"/>\
             <param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor></technique_common></source>\n\
             <vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>\n{primitive}\n\
             </mesh></geometry></library_geometries></COLLADA>"
        )
    }

    fn triangles(indexes: &str) -> String {
        format!(
            "<triangles count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>{indexes}</p></triangles>"
        )
    }

    #[test]
    fn indexes_beyond_the_points_are_an_error_of_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.dae");
        fs::write(&path, collada("float_array", "9", &triangles("0 1 2"))).unwrap();
        assert_eq!(read(&path).unwrap().meshes[0].faces.len(), 1);
        let text = problem("a.dae", collada("float_array", "9", &triangles("0 1 3")).as_bytes());
        assert_eq!(text, "found damaged data: index out of bounds: the len is 3 but the index is 3");
        // The crate may leave this to its user.
        for face in ["f 1 2 9", "f -9 -8 -7"] {
            let path = folder.path().join("a.obj");
            fs::write(&path, format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{face}\n")).unwrap();
            let read = MeshFile { path, scale: [1.0; 3] }.read();
            assert!(read.is_err_and(|error| error.contains("a.obj: ")), "{face}");
        }
    }

    /// The crate would ask for this much memory.
    #[test]
    fn counts_beyond_the_file_are_refused() {
        let text = problem("a.dae", collada("float_array", "4294967295", &triangles("0 1 2")).as_bytes());
        assert!(text.starts_with("line 3: found count 4294967295 of <float_array>, expected at most "), "{text}");
        let polygons = "<polylist count=\"2\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>\n\
                        <vcount>3 4000000000</vcount><p>0 1 2</p></polylist>";
        let text = problem("a.dae", collada("float_array", "9", polygons).as_bytes());
        assert!(text.starts_with("line 6: found polygons with 4000000003 corners, expected at most "), "{text}");
        let far = triangles("0 1 2").replace("offset=\"0\"", "offset=\"1000000000\"");
        let text = problem("a.dae", collada("float_array", "9", &far).as_bytes());
        assert_eq!(text, "line 5: found offset 1000000000 of <input>, expected at most 64");
    }

    /// A binary STL file has as many triangles as bytes for them.
    #[test]
    fn an_stl_file_without_the_triangles_of_its_count_is_refused() {
        let header = [&[b' '; 80][..], &u32::MAX.to_le_bytes(), &[0; 49]].concat();
        let text = problem("a.stl", &header);
        assert!(text.contains("invalid"), "{text}");
    }

    /// The crate would compute without end, or end the process.
    #[test]
    fn arrays_of_names_and_deep_elements_are_refused() {
        let text = problem("a.dae", collada("Name_array", "9", &triangles("0 1 2")).as_bytes());
        assert_eq!(text, "line 3: found <Name_array> in a geometry, expected <float_array>");
        let deep = format!("<COLLADA>\n{}", "<node>".repeat(100_000));
        for name in ["a.dae", "a.mesh"] {
            let text = problem(name, deep.as_bytes());
            assert_eq!(text, "line 2: found elements nested 65 deep, expected at most 64");
        }
    }

    #[test]
    #[cfg(unix)]
    fn materials_without_an_end_are_left_out() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        let materials = "mtllib /dev/zero\n".repeat(1_000);
        fs::write(&path, format!("{materials}v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")).unwrap();
        assert_eq!(read(&path).unwrap().meshes[0].faces, [[0, 1, 2]]);
    }
}
