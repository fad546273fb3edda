use std::io::Write;

use super::*;

fn file(bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file.xml");
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

fn gzipped(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), Default::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// The ids of a file, and whether it is whole.
fn ids(bytes: &[u8]) -> Result<(Vec<String>, bool), SumoFileError> {
    let (_folder, path) = file(bytes);
    let mut ids = Vec::new();
    let mut xml = Xml::open(&path)?;
    xml.each(|element| {
        ids.extend(element.attribute("id"));
        Ok(ControlFlow::Continue(()))
    })?;
    Ok((ids, xml.is_whole()))
}

fn latin1(text: &str) -> Vec<u8> {
    text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect()
}

#[test]
fn law_every_encoding_and_compression_gives_the_same_elements() {
    let text =
        |encoding: &str| format!("<?xml version=\"1.0\" {encoding}?>\n<r><a id=\"Gr\u{fc}n\"/><b id=\"\u{e9}\"/></r>");
    let wide = |text: String, bytes: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(bytes).collect::<Vec<u8>>();
    let files = [
        text("").into_bytes(),
        text("encoding=\"UTF-8\"").into_bytes(),
        text("encoding=\"no\"").replace("encoding=\"no\"", "").into_bytes(),
        format!("\u{feff}{}", text("encoding='UTF-8'")).into_bytes(),
        latin1(&text("encoding=\"ISO-8859-1\"")),
        latin1(&text("encoding = 'windows-1252'")),
        wide(format!("\u{feff}{}", text("encoding=\"UTF-16\"")), u16::to_le_bytes),
        wide(format!("\u{feff}{}", text("encoding=\"UTF-16\"")), u16::to_be_bytes),
        wide(text("encoding=\"UTF-16\""), u16::to_le_bytes),
    ];
    let expected = (vec!["Gr\u{fc}n".to_owned(), "\u{e9}".to_owned()], true);
    for (i, bytes) in files.iter().enumerate() {
        assert_eq!(ids(bytes).unwrap(), expected, "file {i}");
        assert_eq!(ids(&gzipped(bytes)).unwrap(), expected, "file {i}, gzipped");
    }
    let unknown = text("encoding=\"klingon\"");
    assert!(ids(unknown.as_bytes()).unwrap_err().to_string().contains("its encoding \"klingon\" is not known"));
}

#[test]
fn law_a_file_cut_anywhere_is_not_whole_and_gives_no_error() {
    let text = format!("<r>{}</r>", (0..400).map(|i| format!("<a id=\"{}\"/>\n", i * 7919)).collect::<String>());
    let gz = gzipped(text.as_bytes());
    let (all, whole) = ids(&gz).unwrap();
    assert!(whole && all.len() == 400);
    for bytes in [text.as_bytes(), &gz] {
        for cut in (3..bytes.len()).step_by(53) {
            let (some, whole) = ids(&bytes[..cut]).unwrap();
            assert!(!whole && some == all[..some.len()], "cut at {cut} of {}", bytes.len());
        }
    }
}

#[test]
fn errors_name_the_line() {
    let error = |text: &str| ids(text.as_bytes()).unwrap_err().to_string();
    assert!(error("<r>\n<a>\n</r>").contains("file.xml:3: not XML"));
    let (_folder, path) = file(b"<r>\n\n<a\nid=\"x\"/></r>");
    let visited =
        Xml::open(&path).unwrap().each(|e| match e.attribute("id").is_some_and(|id| id.parse::<f64>().is_err()) {
            true => Err("id is not a number".to_owned()),
            false => Ok(ControlFlow::Continue(())),
        });
    assert!(visited.unwrap_err().to_string().ends_with("file.xml:3: id is not a number"));
    let mut corrupt = gzipped(&b"<r><a id=\"x\"/></r>".repeat(1000));
    corrupt[12..40].fill(0xff);
    assert!(ids(&corrupt).unwrap_err().to_string().contains("file.xml: cannot be read"));
}

#[test]
fn law_hostile_files_are_refused_or_read_within_bounds() {
    let deep = "<a>".repeat(1_000_000);
    assert!(ids(deep.as_bytes()).unwrap_err().to_string().contains("nested more than 256 deep"));
    // A billion laughs, and attributes that only the definition names.
    for inner in
        ["[<!ENTITY a \"ha\"><!ENTITY b \"&a;&a;&a;\">]", "[<!ATTLIST x file CDATA \"y\">]", "SYSTEM \"x.dtd\""]
    {
        let error = ids(format!("<r/>\n<!DOCTYPE r {inner}>\n<r><x id=\"&b;&amp;\"/></r>").as_bytes()).unwrap_err();
        assert!(error.to_string().contains("file.xml:2: a document type definition"), "{error}");
    }
    assert_eq!(ids(b"<!DOCTYPE r>\n<r id=\"&b;&amp;\"/>").unwrap(), (vec!["&b;&amp;".to_owned()], true));
    let wide: Vec<u8> = "\u{feff}<r/>".chars().flat_map(|c| u32::from(c).to_le_bytes()).collect();
    assert!(ids(&wide).unwrap_err().to_string().contains("a character 0"));
    let padded = format!("<?xml version=\"1.0\"{} encoding=\"UTF-7\"?><r/>", " ".repeat(300));
    assert!(ids(padded.as_bytes()).unwrap_err().to_string().contains("an XML declaration of more than"));
    let huge = gzipped(&[b"<r id=\"".to_vec(), vec![b'x'; EVENT_MAX + CHUNK], b"\"/>".to_vec()].concat());
    assert!(huge.len() < 1 << 20);
    assert!(ids(&huge).unwrap_err().to_string().contains("one element or text of more than"));
}
