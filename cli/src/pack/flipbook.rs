//! The animation of a clip: every frame is shown for its time and has scale zero at all others.
//!
//! The moments at which frames change are stored once, and the keys of a frame are a part of them: the moment before its own,
//! its own, and that of the next frame. Before the first and after the last of its keys a frame stays as it is at that key.

use super::{
    binary::Binary,
    document::{Accessor, Animation, BufferView, Channel, Pointer, Sampler, Target, TargetExtensions, raw},
    shared::Shared,
};

const UNSIGNED_BYTE: u32 = 5121;
const FLOAT: u32 = 5126;
/// Whether a frame is shown, from key to key. Every frame finds its keys in here.
const SHOWN: [u8; 5] = [0, 1, 0, 1, 1];

/// The nodes of a frame.
pub struct FrameNodes {
    /// The one whose scale is animated.
    pub scaled: u32,
    /// That of the frame's file. Its visibility is animated, and not that of the scaled one, because Babylon.js animates
    /// the visibility of nodes with a mesh only.
    pub own: u32,
}

/// A frame's keys: the first of them among all moments, the first of their values in [`SHOWN`], and their number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Keys {
    moment: usize,
    value: usize,
    count: usize,
}

impl Keys {
    fn new(frame: usize, frames: usize) -> Self {
        let (is_first, is_last) = (frame == 0, frame + 1 == frames);
        let value = match (is_first, is_last) {
            (true, true) => 3,
            (true, false) => 1,
            // The last frame is shown at the end, too, so that a clip that does not loop stops with it.
            (false, true) => 2,
            (false, false) => 0,
        };
        Self { moment: frame.saturating_sub(1), value, count: if is_first { 2 } else { 3 } }
    }
}

/// The animation under construction, and where its accessors and bytes go.
pub struct Flipbook<'a> {
    pub binary: &'a mut Binary,
    pub accessors: &'a mut Shared<Accessor>,
    /// Bytes of the clip's binary chunk, and their places.
    pub bytes: Vec<(u64, Vec<u8>)>,
}

impl Flipbook<'_> {
    /// The animation of all frames. With `visibility`, KHR_node_visibility is animated besides.
    pub fn animation(&mut self, frames: &[FrameNodes], fps: f64, visibility: bool) -> Animation {
        let moments: Vec<f32> = (0..=frames.len()).map(|i| (i as f64 / fps) as f32).collect();
        let times = self.view(moments.iter().flat_map(|time| time.to_le_bytes()).collect());
        let scales = SHOWN.iter().flat_map(|&shown| [f32::from(shown); 3]);
        let scales = self.view(scales.flat_map(f32::to_le_bytes).collect());
        let flags = visibility.then(|| self.view(SHOWN.to_vec()));
        let (mut channels, mut samplers) = (Vec::new(), Vec::new());
        for (i, frame) in frames.iter().enumerate() {
            let keys = Keys::new(i, frames.len());
            let range = [moments[keys.moment], moments[keys.moment + keys.count - 1]];
            let input = self.accessor(times, 4 * keys.moment, FLOAT, "SCALAR", keys.count, Some(range));
            let mut add = |output, target| {
                channels.push(Channel { sampler: samplers.len() as u32, target });
                samplers.push(Sampler { input, output, interpolation: "STEP" });
            };
            let output = self.accessor(scales, 12 * keys.value, FLOAT, "VEC3", keys.count, None);
            add(output, Target { node: Some(frame.scaled), path: "scale", extensions: None });
            if let Some(flags) = flags {
                let output = self.accessor(flags, keys.value, UNSIGNED_BYTE, "SCALAR", keys.count, None);
                let pointer = format!("/nodes/{}/extensions/KHR_node_visibility/visible", frame.own);
                let pointer = Pointer { pointer };
                add(output, Target { node: None, path: "pointer", extensions: Some(TargetExtensions { pointer }) });
            }
        }
        Animation { name: "clip", channels, samplers }
    }

    fn view(&mut self, bytes: Vec<u8>) -> u32 {
        let byte_length = bytes.len() as u64;
        let view =
            BufferView { buffer: 0, byte_offset: 0, byte_length, byte_stride: None, target: None, extensions: None };
        let (index, place) = self.binary.add(view, &bytes);
        self.bytes.extend(place.map(|place| (place, bytes)));
        index
    }

    fn accessor(
        &mut self,
        buffer_view: u32,
        byte_offset: usize,
        component_type: u32,
        kind: &str,
        count: usize,
        range: Option<[f32; 2]>,
    ) -> u32 {
        let [min, max] = [0, 1].map(|end| range.map(|range| raw(&[f64::from(range[end])])));
        let (byte_offset, count, kind) = (byte_offset as u64, count as u64, kind.to_owned());
        self.accessors.add(Accessor {
            buffer_view,
            byte_offset,
            component_type,
            normalized: None,
            count,
            kind,
            min,
            max,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_two_moments_exactly_one_frame_is_shown() {
        for frames in 1..6 {
            let shown = |frame: usize, moment: usize| {
                let Keys { moment: first, value, count } = Keys::new(frame, frames);
                SHOWN[value + moment.saturating_sub(first).min(count - 1)]
            };
            for moment in 0..=frames {
                let seen: Vec<usize> = (0..frames).filter(|&frame| shown(frame, moment) == 1).collect();
                assert_eq!(seen, [moment.min(frames - 1)], "{frames} frames, moment {moment}");
            }
        }
    }
}
