//! A value as it crosses: a type's name and named arrays of numbers.

use std::borrow::Cow;

/// Elements of an array, borrowed from the other side or owned.
#[derive(Clone, Debug, PartialEq)]
pub enum Elements<'a> {
    /// Bytes; also the UTF-8 of texts.
    U8(Cow<'a, [u8]>),
    /// Unsigned, 16 bits.
    U16(Cow<'a, [u16]>),
    /// Unsigned, 32 bits.
    U32(Cow<'a, [u32]>),
    /// Unsigned, 64 bits.
    U64(Cow<'a, [u64]>),
    /// IEEE single.
    F32(Cow<'a, [f32]>),
    /// IEEE double.
    F64(Cow<'a, [f64]>),
}

/// The same expression for whichever elements there are.
macro_rules! each {
    ($elements:expr, $array:ident => $then:expr) => {
        match $elements {
            Elements::U8($array) => $then,
            Elements::U16($array) => $then,
            Elements::U32($array) => $then,
            Elements::U64($array) => $then,
            Elements::F32($array) => $then,
            Elements::F64($array) => $then,
        }
    };
}

/// The same, wrapped in its variant again.
macro_rules! map {
    ($elements:expr, $array:ident => $then:expr) => {
        match $elements {
            Elements::U8($array) => Elements::U8($then),
            Elements::U16($array) => Elements::U16($then),
            Elements::U32($array) => Elements::U32($then),
            Elements::U64($array) => Elements::U64($then),
            Elements::F32($array) => Elements::F32($then),
            Elements::F64($array) => Elements::F64($then),
        }
    };
}

impl Elements<'_> {
    /// Number of elements.
    #[must_use]
    pub fn count(&self) -> usize {
        each!(self, array => array.len())
    }

    /// What they are, as `carvegraph.h` writes it: "u8" to "f64".
    #[must_use]
    pub fn element(&self) -> &'static str {
        match self {
            Self::U8(_) => "u8",
            Self::U16(_) => "u16",
            Self::U32(_) => "u32",
            Self::U64(_) => "u64",
            Self::F32(_) => "f32",
            Self::F64(_) => "f64",
        }
    }

    /// The same elements, borrowed.
    #[must_use]
    pub fn view(&self) -> Elements<'_> {
        map!(self, array => Cow::Borrowed(array))
    }

    /// The same elements, copied if they were borrowed.
    #[must_use]
    pub fn into_owned(self) -> Elements<'static> {
        map!(self, array => Cow::Owned(array.into_owned()))
    }
}

/// A named array of a value.
#[derive(Clone, Debug, PartialEq)]
pub struct RawArray<'a> {
    /// Its name, such as "heights".
    pub name: Cow<'a, str>,
    /// What it holds.
    pub elements: Elements<'a>,
}

impl RawArray<'_> {
    fn view(&self) -> RawArray<'_> {
        RawArray { name: Cow::Borrowed(&self.name), elements: self.elements.view() }
    }

    fn into_owned(self) -> RawArray<'static> {
        let name = Cow::Owned(self.name.into_owned());
        RawArray { name, elements: self.elements.into_owned() }
    }
}

/// A value as it crosses: a type and named arrays, in the order that `carvegraph.h` lists.
#[derive(Clone, Debug, PartialEq)]
pub struct Raw<'a> {
    /// Its type, such as "height_field".
    pub type_name: Cow<'a, str>,
    /// Its arrays.
    pub arrays: Vec<RawArray<'a>>,
}

impl Raw<'_> {
    /// The same value, its arrays borrowed.
    #[must_use]
    pub fn view(&self) -> Raw<'_> {
        let arrays = self.arrays.iter().map(RawArray::view).collect();
        Raw { type_name: Cow::Borrowed(&self.type_name), arrays }
    }

    /// The same value, its arrays copied if they were borrowed.
    #[must_use]
    pub fn into_owned(self) -> Raw<'static> {
        let arrays = self.arrays.into_iter().map(RawArray::into_owned).collect();
        Raw { type_name: Cow::Owned(self.type_name.into_owned()), arrays }
    }
}

impl<'a> Raw<'a> {
    /// A value without arrays yet.
    #[must_use]
    pub fn new(type_name: &'a str) -> Self {
        Self { type_name: Cow::Borrowed(type_name), arrays: Vec::new() }
    }

    /// Adds the next array.
    #[must_use]
    pub fn with(mut self, name: &'a str, elements: impl Into<Elements<'a>>) -> Self {
        self.arrays.push(RawArray { name: Cow::Borrowed(name), elements: elements.into() });
        self
    }

    /// Adds a number that counts something.
    pub(super) fn with_count(self, name: &'a str, count: usize) -> Self {
        self.with(name, vec![count as u64])
    }

    /// Adds a text.
    pub(super) fn with_text(self, name: &'a str, text: Cow<'a, str>) -> Self {
        self.with(
            name,
            match text {
                Cow::Borrowed(text) => Cow::Borrowed(text.as_bytes()),
                Cow::Owned(text) => Cow::Owned(text.into_bytes()),
            },
        )
    }

    /// Adds tuples of `N` numbers, one after the other.
    pub(super) fn with_tuples<T: Clone, const N: usize>(
        self,
        name: &'a str,
        tuples: Cow<'a, [[T; N]]>,
    ) -> Self
    where
        Elements<'a>: From<Cow<'a, [T]>>,
    {
        self.with(
            name,
            match tuples {
                Cow::Borrowed(tuples) => Cow::Borrowed(tuples.as_flattened()),
                Cow::Owned(tuples) => Cow::Owned(tuples.into_flattened()),
            },
        )
    }
}

macro_rules! elements_from {
    ($($variant:ident $element:ty),*) => {$(
        impl<'a> From<Cow<'a, [$element]>> for Elements<'a> {
            fn from(array: Cow<'a, [$element]>) -> Self {
                Self::$variant(array)
            }
        }

        impl<'a> From<&'a [$element]> for Elements<'a> {
            fn from(array: &'a [$element]) -> Self {
                Self::$variant(Cow::Borrowed(array))
            }
        }

        impl From<Vec<$element>> for Elements<'_> {
            fn from(array: Vec<$element>) -> Self {
                Self::$variant(Cow::Owned(array))
            }
        }
    )*};
}

elements_from!(U8 u8, U16 u16, U32 u32, U64 u64, F32 f32, F64 f64);
