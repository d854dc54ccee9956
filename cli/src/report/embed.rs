//! Files of a run as parts of a page: pictures as `data:` addresses, texts as they are.

use super::words::clean;
use minijinja::Value;
use serde::Serialize;
use std::fs;
use std::path::Path;

/// A larger picture is named but not shown: a browser would choke on it, and so would who is sent the page.
const MAX_PICTURE_BYTES: u64 = 16 << 20;

/// All pictures together; those beyond are only named.
const MAX_PICTURES_BYTES: u64 = 64 << 20;

/// Summaries take some kilobytes; what is longer is no summary.
const MAX_TEXT_BYTES: u64 = 256 << 10;

/// What browsers show of what nodes write.
const PICTURES: [(&str, &str); 4] =
    [("png", "image/png"), ("svg", "image/svg+xml"), ("jpg", "image/jpeg"), ("webp", "image/webp")];

/// A picture in a page.
#[derive(Serialize)]
pub(super) struct Picture {
    /// The file's name.
    pub(super) name: String,
    /// Its contents as an address; `None` if it is not shown.
    data: Option<Value>,
}

/// A text in a page.
#[derive(Serialize)]
pub(super) struct Text {
    name: String,
    text: String,
}

/// Takes pictures and texts in until they are too many.
#[derive(Default)]
pub(super) struct Embedded {
    pub(super) pictures: Vec<Picture>,
    pub(super) texts: Vec<Text>,
    bytes: u64,
}

impl Embedded {
    /// Takes in a file that was written, if it is a picture or a text.
    pub(super) fn take(&mut self, path: &Path, name: &str, bytes: u64) {
        let ending = name.rsplit('.').next().unwrap_or_default().to_ascii_lowercase();
        if let Some((_, kind)) = PICTURES.iter().find(|(known, _)| *known == ending) {
            let fits = bytes <= MAX_PICTURE_BYTES && self.bytes + bytes <= MAX_PICTURES_BYTES;
            // A file that cannot be read again is only named.
            let contents = fits.then(|| fs::read(path).ok()).flatten();
            self.bytes += contents.as_ref().map_or(0, |contents| contents.len() as u64);
            let data = contents.map(|contents| address(kind, &contents));
            self.pictures.push(Picture { name: name.to_owned(), data });
        } else if ending == "txt"
            && bytes <= MAX_TEXT_BYTES
            && let Ok(contents) = fs::read(path)
        {
            let text = clean(&String::from_utf8_lossy(&contents));
            self.texts.push(Text { name: name.to_owned(), text });
        }
    }
}

/// Nothing in it needs escaping.
fn address(kind: &str, contents: &[u8]) -> Value {
    Value::from_safe_string(format!("data:{kind};base64,{}", base64(contents)))
}

/// RFC 4648, section 4.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let byte = |at: usize| u32::from(three.get(at).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for letter in 0..4 {
            let sextet = bits >> (18 - 6 * letter) & 63;
            text.push(if letter > three.len() { '=' } else { LETTERS[sextet as usize] as char });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_the_standard() {
        // RFC 4648, section 10.
        let pairs = [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ];
        for (plain, coded) in pairs {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
        assert_eq!(base64(&[0xfb, 0xff, 0xbf]), "+/+/");
    }

    #[test]
    fn what_is_too_large_or_gone_is_only_named() {
        let mut embedded = Embedded::default();
        let nowhere = Path::new("no such folder");
        embedded.take(&nowhere.join("a.png"), "a.png", 10);
        embedded.take(&nowhere.join("b.PNG"), "b.PNG", MAX_PICTURE_BYTES + 1);
        embedded.take(&nowhere.join("c.txt"), "c.txt", 10);
        embedded.take(&nowhere.join("d.stl"), "d.stl", 10);
        let names: Vec<_> = embedded.pictures.iter().map(|picture| &picture.name[..]).collect();
        assert_eq!(names, ["a.png", "b.PNG"]);
        assert!(embedded.pictures.iter().all(|picture| picture.data.is_none()));
        assert!(embedded.texts.is_empty());
    }
}
