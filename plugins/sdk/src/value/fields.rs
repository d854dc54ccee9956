//! Reads the arrays of a value in their order.

use super::error::shown;
use super::{Elements, Raw, RawArray, ValueError, check_type};
use std::borrow::Cow;
use std::ops::Range;
use std::vec::IntoIter;

/// The arrays of a value of the type `of` that are still to be read.
pub(super) struct Fields<'a> {
    of: &'static str,
    arrays: IntoIter<RawArray<'a>>,
}

/// Elements of one kind.
pub(super) trait Element: Copy + 'static {
    /// Its name in `carvegraph.h`.
    const NAME: &'static str;

    /// The array, if it is of this kind.
    fn array(elements: Elements<'_>) -> Option<Cow<'_, [Self]>>;
}

macro_rules! element {
    ($($variant:ident $element:ident),*) => {$(
        impl Element for $element {
            const NAME: &'static str = stringify!($element);

            fn array(elements: Elements<'_>) -> Option<Cow<'_, [Self]>> {
                if let Elements::$variant(array) = elements { Some(array) } else { None }
            }
        }
    )*};
}

element!(U8 u8, U32 u32, U64 u64, F32 f32, F64 f64);

impl<'a> Fields<'a> {
    /// Begins with the first array of `raw`, which must be of the type `of`.
    pub(super) fn open(raw: Raw<'a>, of: &'static str) -> Result<Self, ValueError> {
        check_type(&raw, of)?;
        Ok(Self { of, arrays: raw.arrays.into_iter() })
    }

    /// The next array, whatever its elements.
    pub(super) fn any(&mut self, wanted: &'static str) -> Result<Elements<'a>, ValueError> {
        let of = self.of;
        let array = self.arrays.next().ok_or(ValueError::Missing { of, wanted })?;
        if array.name == wanted {
            return Ok(array.elements);
        }
        Err(ValueError::Name { of, wanted, given: shown(&array.name) })
    }

    /// The next array.
    pub(super) fn array<T: Element>(
        &mut self,
        name: &'static str,
    ) -> Result<Cow<'a, [T]>, ValueError> {
        let elements = self.any(name)?;
        let (of, given) = (self.of, elements.element());
        T::array(elements).ok_or(ValueError::Element { of, array: name, wanted: T::NAME, given })
    }

    /// The next array, which is of `count` elements.
    pub(super) fn array_of<T: Element>(
        &mut self,
        name: &'static str,
        count: usize,
    ) -> Result<Cow<'a, [T]>, ValueError> {
        let array = self.array(name)?;
        self.check_length(name, array.len(), array.len() == count, &count)?;
        Ok(array)
    }

    /// The next array, which is of one element.
    pub(super) fn one<T: Element>(&mut self, name: &'static str) -> Result<T, ValueError> {
        Ok(self.array_of(name, 1)?[0])
    }

    /// The next array, which is of one number that counts something.
    pub(super) fn count(&mut self, name: &'static str) -> Result<usize, ValueError> {
        let given = self.one::<u64>(name)?;
        let fault = |_| self.too_large(name, 0, given, usize::MAX as u64);
        usize::try_from(given).map_err(fault)
    }

    /// The next array, which is of `N` elements or of none.
    pub(super) fn none_or<T: Element, const N: usize>(
        &mut self,
        name: &'static str,
    ) -> Result<Option<[T; N]>, ValueError> {
        let array = self.array(name)?;
        let fits = array.is_empty() || array.len() == N;
        self.check_length(name, array.len(), fits, &format_args!("{N} or none"))?;
        Ok(array.first_chunk().copied())
    }

    /// The next array, which is of tuples of `N` elements. Copied once if it is owned.
    pub(super) fn tuples<T: Element, const N: usize>(
        &mut self,
        name: &'static str,
    ) -> Result<Cow<'a, [[T; N]]>, ValueError> {
        let array = self.array(name)?;
        let fits = array.len() % N == 0;
        self.check_length(name, array.len(), fits, &format_args!("a multiple of {N}"))?;
        Ok(match array {
            Cow::Borrowed(array) => Cow::Borrowed(array.as_chunks().0),
            Cow::Owned(array) => Cow::Owned(array.as_chunks().0.to_vec()),
        })
    }

    /// The next array, which is of `count` tuples.
    pub(super) fn tuples_of<T: Element, const N: usize>(
        &mut self,
        name: &'static str,
        count: usize,
    ) -> Result<Cow<'a, [[T; N]]>, ValueError> {
        let tuples = self.tuples(name)?;
        let wanted = format_args!("{N} for each of {count}");
        self.check_length(name, tuples.len() * N, tuples.len() == count, &wanted)?;
        Ok(tuples)
    }

    /// The next array, which is of codes of `words`: each stands for the word of that place.
    pub(super) fn words<T: Copy>(
        &mut self,
        name: &'static str,
        words: &[T],
    ) -> Result<Vec<T>, ValueError> {
        let codes = self.array::<u8>(name)?;
        let word = |(place, &code): (usize, &u8)| {
            let fault = || self.too_large(name, place, code.into(), words.len() as u64);
            words.get(usize::from(code)).copied().ok_or_else(fault)
        };
        codes.iter().enumerate().map(word).collect()
    }

    /// As [`words`](Self::words), of which there must be `count`.
    pub(super) fn words_of<T: Copy>(
        &mut self,
        name: &'static str,
        words: &[T],
        count: usize,
    ) -> Result<Vec<T>, ValueError> {
        let array = self.words(name, words)?;
        self.check_length(name, array.len(), array.len() == count, &count)?;
        Ok(array)
    }

    /// The next array, which is a text.
    pub(super) fn text(&mut self, name: &'static str) -> Result<Cow<'a, str>, ValueError> {
        let of = self.of;
        let text = match self.array::<u8>(name)? {
            Cow::Borrowed(bytes) => std::str::from_utf8(bytes).ok().map(Cow::Borrowed),
            Cow::Owned(bytes) => String::from_utf8(bytes).ok().map(Cow::Owned),
        };
        text.ok_or(ValueError::Text { of, array: name })
    }

    /// Whether nothing is left over.
    pub(super) fn end(mut self) -> Result<(), ValueError> {
        match self.arrays.next() {
            None => Ok(()),
            Some(array) => Err(ValueError::Extra { of: self.of, given: shown(&array.name) }),
        }
    }

    /// A fault of the array `name` with `given` elements, unless it fits.
    pub(super) fn check_length(
        &self,
        name: &'static str,
        given: usize,
        fits: bool,
        wanted: &dyn std::fmt::Display,
    ) -> Result<(), ValueError> {
        if fits {
            return Ok(());
        }
        Err(ValueError::Length { of: self.of, array: name, wanted: wanted.to_string(), given })
    }

    /// The runs of `counts` points each that make up all `points`.
    pub(super) fn runs(
        &self,
        counts: &[u64],
        points: usize,
    ) -> Result<Vec<Range<usize>>, ValueError> {
        let of = self.of;
        let mut runs = Vec::with_capacity(counts.len());
        let mut start = 0;
        for (place, &count) in counts.iter().enumerate() {
            let left = points - start;
            let fitting = usize::try_from(count).ok().filter(|count| *count <= left);
            let end = start + fitting.ok_or(ValueError::SpanTooLong { of, place, count, left })?;
            if end == start {
                return Err(ValueError::SpanEmpty { of, place });
            }
            runs.push(start..end);
            start = end;
        }
        if start == points { Ok(runs) } else { Err(ValueError::SpansTooFew { of, start, points }) }
    }

    /// A fault of one element.
    pub(super) fn too_large(
        &self,
        array: &'static str,
        place: usize,
        given: u64,
        limit: u64,
    ) -> ValueError {
        ValueError::TooLarge { of: self.of, array, place, given, limit }
    }
}
