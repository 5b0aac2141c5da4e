//! Numbers of a glTF file: strided, normalised, sparse.

use super::container::File;
use super::json::{Accessor, BufferView};
use crate::Result;

/// How one number is stored.
#[derive(Clone, Copy)]
struct Component {
    code: u32,
    size: usize,
}

impl Component {
    fn of(code: u32) -> Option<Self> {
        let size = match code {
            5120 | 5121 => 1,
            5122 | 5123 => 2,
            5125 | 5126 => 4,
            _ => return None,
        };
        Some(Self { code, size })
    }

    /// The number that starts a slice, which is long enough.
    fn number(self, bytes: &[u8], normalized: bool) -> f64 {
        let at = |i: usize| bytes.get(i).copied().unwrap_or(0);
        let word = u32::from_le_bytes([at(0), at(1), at(2), at(3)]);
        let (number, full) = match self.code {
            5120 => (f64::from(at(0) as i8), f64::from(i8::MAX)),
            5121 => (f64::from(at(0)), f64::from(u8::MAX)),
            5122 => (f64::from(word as u16 as i16), f64::from(i16::MAX)),
            5123 => (f64::from(word as u16), f64::from(u16::MAX)),
            5125 => (f64::from(word), f64::from(u32::MAX)),
            _ => return f64::from(f32::from_bits(word)),
        };
        // The most negative code and the next one both mean -1.
        if normalized { (number / full).max(-1.0) } else { number }
    }
}

/// Numbers per element.
fn width(shape: &str) -> Option<usize> {
    Some(match shape {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" => 4,
        "MAT4" => 16,
        _ => return None,
    })
}

impl File {
    /// The elements of an accessor, `N` numbers each. `by` names who asks.
    pub(super) fn numbers<const N: usize>(&self, index: usize, by: &str) -> Result<Vec<[f64; N]>> {
        let accessor = self.entry(&self.root.accessors, index, "accessor", by)?;
        let place = format!("accessor {index} ({by})");
        let component = Component::of(accessor.component_type).ok_or_else(|| {
            self.error(&place, format!("has the unknown component type {}", accessor.component_type))
        })?;
        if width(&accessor.shape) != Some(N) {
            return Err(self.error(&place, format!("holds {}, not elements of {N} numbers", accessor.shape)));
        }
        let mut elements = match accessor.buffer_view {
            Some(view) => {
                let view = self.entry(&self.root.buffer_views, view, "buffer view", &place)?;
                let stride = view.byte_stride.unwrap_or(N * component.size);
                let span = Span { offset: accessor.byte_offset, stride, count: accessor.count };
                self.elements(&place, view, span, component, accessor.normalized)?
            }
            None => vec![[0.0; N]; self.plausible(&place, accessor.count)?],
        };
        self.patch(&place, accessor, component, &mut elements)?;
        match elements.iter().position(|element| element.iter().any(|number| !number.is_finite())) {
            Some(element) => Err(self
                .error(place, format!("element {element} is not a finite number"))
                .fix("export it again")),
            None => Ok(elements),
        }
    }

    /// A count that no file contradicts: without bytes of its own, it could be anything.
    fn plausible(&self, place: &str, count: usize) -> Result<usize> {
        match count <= MOST_ELEMENTS {
            true => Ok(count),
            false => Err(self.error(place, format!("claims {count} elements"))),
        }
    }

    /// Replaces the elements that stand apart.
    fn patch<const N: usize>(
        &self,
        place: &str,
        accessor: &Accessor,
        component: Component,
        elements: &mut [[f64; N]],
    ) -> Result<()> {
        let Some(sparse) = &accessor.sparse else { return Ok(()) };
        let place = format!("{place}, sparse");
        let index_type = Component::of(sparse.indices.component_type)
            .ok_or_else(|| self.error(&place, "its indices have an unknown component type"))?;
        let views = &self.root.buffer_views;
        let view = self.entry(views, sparse.indices.buffer_view, "buffer view", &place)?;
        let span = Span { offset: sparse.indices.byte_offset, stride: index_type.size, count: sparse.count };
        let indices: Vec<[f64; 1]> = self.elements(&place, view, span, index_type, false)?;
        let view = self.entry(views, sparse.values.buffer_view, "buffer view", &place)?;
        let span =
            Span { offset: sparse.values.byte_offset, stride: N * component.size, count: sparse.count };
        let values = self.elements(&place, view, span, component, accessor.normalized)?;
        let count = elements.len();
        for ([index], value) in indices.into_iter().zip(values) {
            let element = elements.get_mut(index as usize).ok_or_else(|| {
                self.error(&place, format!("replaces element {index}, but there are {count}"))
            })?;
            *element = value;
        }
        Ok(())
    }

    fn elements<const N: usize>(
        &self,
        place: &str,
        view: &BufferView,
        span: Span,
        component: Component,
        normalized: bool,
    ) -> Result<Vec<[f64; N]>> {
        let buffer = self.entry(&self.buffers, view.buffer, "buffer", place)?;
        let size = N * component.size;
        let short = || {
            self.error(place, "reaches beyond its buffer")
                .fix("the file was cut or is damaged; export it again")
        };
        let bytes = view
            .byte_offset
            .checked_add(view.byte_length)
            .and_then(|end| buffer.get(view.byte_offset..end))
            .and_then(|bytes| bytes.get(span.offset..))
            .ok_or_else(short)?;
        let needed = match span.count {
            0 => 0,
            count => (count - 1)
                .checked_mul(span.stride)
                .and_then(|start| start.checked_add(size))
                .ok_or_else(short)?,
        };
        if needed > bytes.len() || span.stride < size {
            return Err(short());
        }
        let element = |i: usize| -> [f64; N] {
            let bytes = &bytes[i * span.stride..i * span.stride + size];
            std::array::from_fn(|axis| component.number(&bytes[axis * component.size..], normalized))
        };
        Ok((0..span.count).map(element).collect())
    }
}

/// More than any mesh has.
const MOST_ELEMENTS: usize = 1 << 28;

/// Where elements stand in a view.
#[derive(Clone, Copy)]
struct Span {
    offset: usize,
    stride: usize,
    count: usize,
}
