//! A synthetic capture dome with exact ground truth.
