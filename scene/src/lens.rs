//! Lenses as scene.json holds them: the name of a model, and a list of coefficients in OpenCV's order.

use pcmvs_core::Lens;
use serde::{Deserialize, Serialize};

/// Models of a lens.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LensModel {
    /// OpenCV's k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4: 4, 5, 8 or 12 of them.
    #[default]
    OpenCv,
    /// OpenCV's fisheye, which is equidistant: k1 k2 k3 k4.
    Fisheye,
}

impl LensModel {
    pub(crate) fn is_opencv(&self) -> bool {
        *self == Self::OpenCv
    }
}

/// The lens with these coefficients. The error says what is wrong with them.
pub fn read(model: LensModel, list: &[f64]) -> Result<Lens, String> {
    let used = list.len() - list.iter().rev().take_while(|&&v| v == 0.0).count();
    match model {
        LensModel::OpenCv if used > 12 => Err(String::from(
            "has coefficients beyond k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4, those of OpenCV's tilted model, which is not \
             supported: calibrate without CALIB_TILTED_MODEL",
        )),
        LensModel::OpenCv if used > 5 && !matches!(list.len(), 8 | 12 | 14) => Err(format!(
            "has {} numbers, but OpenCV's model has 4, 5, 8 or 12: write k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4",
            list.len()
        )),
        LensModel::OpenCv => Ok(Lens::OpenCv(std::array::from_fn(|i| list.get(i).copied().unwrap_or(0.0)))),
        LensModel::Fisheye => match *list {
            [k1, k2, k3, k4] => Ok(Lens::Fisheye([k1, k2, k3, k4])),
            _ => Err(format!("has {} numbers, but a fisheye has 4: write k1 k2 k3 k4", list.len())),
        },
    }
}

/// Model and coefficients of a lens. Of OpenCV's, no more are written than it needs, and no fewer than five.
pub fn write(lens: &Lens) -> (LensModel, Vec<f64>) {
    match lens {
        Lens::OpenCv(all) => {
            let rest_is_zero = |from: usize| all[from..].iter().all(|&v| v == 0.0);
            let count = [5, 8].into_iter().find(|&count| rest_is_zero(count)).unwrap_or(all.len());
            (LensModel::OpenCv, all[..count].to_vec())
        }
        Lens::Fisheye(all) => (LensModel::Fisheye, all.to_vec()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lenses_are_read_as_they_are_written() {
        let of = |count: usize| Lens::OpenCv(std::array::from_fn(|i| if i < count { 0.1 + i as f64 } else { 0.0 }));
        for (lens, length) in
            [(Lens::NONE, 5), (of(4), 5), (of(5), 5), (of(6), 8), (of(8), 8), (of(9), 12), (of(12), 12)]
        {
            let (model, list) = write(&lens);
            assert_eq!((model, list.len()), (LensModel::OpenCv, length));
            assert_eq!(read(model, &list), Ok(lens));
        }
        let fisheye = Lens::Fisheye([0.1, 0.0, 0.2, 0.0]);
        assert_eq!(write(&fisheye), (LensModel::Fisheye, vec![0.1, 0.0, 0.2, 0.0]));
        assert_eq!(read(LensModel::Fisheye, &[0.1, 0.0, 0.2, 0.0]), Ok(fisheye));
    }

    #[test]
    fn lists_of_no_model_are_refused() {
        let opencv = |list: &[f64]| read(LensModel::OpenCv, list);
        assert_eq!(opencv(&[0.1]), Ok(Lens::brown([0.1, 0.0, 0.0, 0.0, 0.0])));
        assert_eq!(opencv(&[0.0; 14]), Ok(Lens::NONE));
        assert_eq!(opencv(&[0.0; 7]), Ok(Lens::NONE));
        assert!(opencv(&[0.1; 7]).unwrap_err().contains("7 numbers"));
        assert!(opencv(&[0.1; 14]).unwrap_err().contains("tilted"));
        assert!(read(LensModel::Fisheye, &[0.1; 5]).unwrap_err().contains("5 numbers"));
        assert!(read(LensModel::Fisheye, &[]).unwrap_err().contains("0 numbers"));
    }
}
