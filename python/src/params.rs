//! Parameters of the method.

use crate::error::Problem;
use pcmvs_core::{Params, Preset};
use pyo3::{prelude::*, types::PyDict};
use serde::Serialize;

const PRESETS: [(&str, Preset); 4] =
    [("default", Preset::Default), ("paper", Preset::Paper), ("hull", Preset::Hull), ("preview", Preset::Preview)];

fn named(name: &str) -> Result<Params, Problem> {
    let found = PRESETS.iter().find(|(known, _)| *known == name);
    let names = || PRESETS.map(|(name, _)| name);
    let preset =
        found.ok_or_else(|| Problem::argument(format!("params is {name:?}: it is one of {:?}, or a dict", names())))?;
    Ok(Params::preset(preset.1))
}

/// A value as Python's dictionaries, lists and numbers.
pub fn to_python<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(|e| Problem::argument(e.to_string()))?;
    py.import("json")?.call_method1("loads", (text,))
}

/// All parameters of a preset, "default", "paper", "hull" or "preview". Change some of them and pass them to a frame. None
/// leaves a step out. What they mean is in the documentation of the Rust crate ``pcmvs-core``, under ``Params``.
#[pyfunction]
pub fn preset<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    to_python(py, &named(name)?)
}

/// The parameters that the caller asks for: the name of a preset, or a dictionary with all of them.
#[derive(FromPyObject)]
pub enum Asked<'py> {
    Preset(String),
    All(Bound<'py, PyDict>),
}

impl Default for Asked<'_> {
    fn default() -> Self {
        Self::Preset(String::from("default"))
    }
}

impl Asked<'_> {
    pub fn read(&self) -> PyResult<Params> {
        let dict = match self {
            Self::Preset(name) => return Ok(named(name)?),
            Self::All(dict) => dict,
        };
        let text: String = dict.py().import("json")?.call_method1("dumps", (dict,))?.extract()?;
        let refused = |e| Problem::argument(format!("params: {e}: change what pcmvs.preset returns"));
        Ok(serde_json::from_str(&text).map_err(refused)?)
    }
}
