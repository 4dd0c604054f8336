//! Progress to a JavaScript function, which can cancel.

use crate::{error::Failed, types::ProgressFunction};
use js_sys::Function;
use pcmvs_core::{Error, Progress, Stage};
use send_wrapper::SendWrapper;
use std::cell::{Cell, RefCell};
use wasm_bindgen::{JsCast, JsValue};

/// The stage that was reported last, and what the callback threw.
struct State {
    callback: Option<Function>,
    stage: Cell<Option<Stage>>,
    thrown: RefCell<Option<JsValue>>,
}

/// Calls `(stage, done, total) => boolean | void`; false cancels, and so does throwing.
pub struct Callback(SendWrapper<State>);

impl Callback {
    /// Without a function nothing is reported and nothing cancels.
    pub fn new(callback: Option<ProgressFunction>) -> Self {
        let callback = callback.map(JsCast::unchecked_into);
        Self(SendWrapper::new(State { callback, stage: Cell::default(), thrown: RefCell::default() }))
    }

    /// What to throw when the work ends with an error: what the function threw, if it did, or what the core reports.
    pub fn failed(&self, error: &Error) -> Failed {
        match self.0.thrown.borrow_mut().take() {
            Some(thrown) => thrown.into(),
            None => Failed::core(error, self.0.stage.get()),
        }
    }

    fn call(&self, stage: Stage, done: u32, total: u32) -> bool {
        let Some(callback) = &self.0.callback else { return true };
        match callback.call3(&JsValue::NULL, &stage.name().into(), &done.into(), &total.into()) {
            Ok(answer) => answer.as_bool() != Some(false),
            Err(thrown) => {
                self.0.thrown.borrow_mut().get_or_insert(thrown);
                false
            }
        }
    }
}

impl Progress for Callback {
    fn on_stage_start(&self, stage: Stage) {
        self.0.stage.set(Some(stage));
        self.call(stage, 0, 1);
    }

    fn on_stage_end(&self, stage: Stage) {
        self.call(stage, 1, 1);
    }

    fn step(&self, stage: Stage, done: u32, total: u32) -> bool {
        self.0.thrown.borrow().is_none() && self.call(stage, done, total)
    }
}
