//! Whole reconstructions of tiny pictures with cameras, masks and parameters that the fuzzer chooses.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pcmvs_core::{Frame, ImageRef, Lens, Mask, Memory, Params, PixelFormat, Preset, Rig, Serial, Silent, ViewInput};
use pcmvs_fuzz::{Bytes, assert_closed, ring};

const SIZE: u32 = 16;

fn gray(bytes: &[u8]) -> ImageRef<'_> {
    ImageRef::packed(bytes, SIZE, SIZE, PixelFormat::Gray8)
}

fn input([picture, mask]: &[Vec<u8>; 2]) -> ViewInput<'_> {
    ViewInput { image: gray(picture), mask: Mask::Given(gray(mask)) }
}

fuzz_target!(|bytes: &[u8]| {
    let mut bytes = Bytes(bytes);
    let mut cameras = ring(3 + bytes.below(4) as u32, SIZE);
    for _ in 0..bytes.below(4) {
        let (one, what, axis, number) = (bytes.below(cameras.len()), bytes.below(7), bytes.below(3), bytes.number());
        let camera = &mut cameras[one];
        match what {
            0 => camera.k[0][0] *= number,
            1 => [0, 1].iter().for_each(|&i| camera.k[i][i] *= number),
            2 => camera.k[axis.min(1)][2] += number,
            3 => camera.t[axis] += number,
            4 => camera.t = camera.t.map(|v| v * number),
            5 => {
                let mut coefficients = [0.0; 5];
                coefficients[axis] = number;
                camera.lens = Lens::brown(coefficients);
            }
            _ => camera.r.swap(axis, (axis + 1) % 3),
        }
    }
    let preset = [Preset::Default, Preset::Paper, Preset::Hull, Preset::Preview][bytes.below(4)];
    let limit = u64::from(bytes.byte()) << 20;
    let Ok(rig) = Rig::new(&cameras) else { return };
    let pixels = (SIZE * SIZE) as usize;
    let mut data = vec![[0u8; 2]; pixels * cameras.len()];
    for (i, pair) in data.iter_mut().enumerate() {
        // A disc, of which the fuzzer's bytes change pixels.
        let (x, y) = ((i as i32 % SIZE as i32) - 8, (i % pixels) as i32 / SIZE as i32 - 8);
        let inside = if x * x + y * y < 36 { 255 } else { 0 };
        let change = bytes.byte();
        *pair = [change ^ (i as u8), inside ^ if change & 3 == 3 { change } else { 0 }];
    }
    let planes: Vec<[Vec<u8>; 2]> =
        data.chunks(pixels).map(|view| [0, 1].map(|k| view.iter().map(|pair| pair[k]).collect())).collect();
    let inputs: Vec<ViewInput> = planes.iter().map(input).collect();
    let memory = if limit > 0 { Memory::limited(limit) } else { Memory::kept() };
    let mut frame = Frame::new(&rig, Params::preset(preset), memory);
    if frame.run_all(&inputs, &Serial, &Silent).is_ok() {
        assert_closed(frame.mesh());
    }
});
