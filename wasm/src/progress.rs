//! Progress to a JavaScript function, which can cancel.

use crate::{error::Failed, types::ProgressFunction};
use js_sys::Function;
use pcmvs_core::{Error, Progress, Stage};
use send_wrapper::SendWrapper;
use std::{
    cell::{Cell, RefCell},
    sync::atomic::{AtomicBool, Ordering},
};
use wasm_bindgen::{JsCast, JsValue};

/// The stage that was reported last, and what the callback threw.
struct State {
    callback: Option<Function>,
    stage: Cell<Option<Stage>>,
    thrown: RefCell<Option<JsValue>>,
}

/// Calls `(stage, done, total) => boolean | void`; false cancels, and so does throwing.
///
/// A function of JavaScript belongs to one thread. The steps of other threads are not reported: `done` counts all of them,
/// so that the next step of this thread reports them, too.
pub struct Callback {
    state: SendWrapper<State>,
    cancelled: AtomicBool,
}

impl Callback {
    /// Without a function nothing is reported and nothing cancels.
    pub fn new(callback: Option<ProgressFunction>) -> Self {
        let callback = callback.map(JsCast::unchecked_into);
        let state = SendWrapper::new(State { callback, stage: Cell::default(), thrown: RefCell::default() });
        Self { state, cancelled: AtomicBool::new(false) }
    }

    /// What to throw when the work ends with an error: what the function threw, if it did, or what the core reports.
    pub fn failed(&self, error: &Error) -> Failed {
        match self.state.thrown.borrow_mut().take() {
            Some(thrown) => thrown.into(),
            None => Failed::core(error, self.state.stage.get()),
        }
    }

    fn call(&self, stage: Stage, done: u32, total: u32) -> bool {
        let Some(callback) = &self.state.callback else { return true };
        match callback.call3(&JsValue::NULL, &stage.name().into(), &done.into(), &total.into()) {
            Ok(answer) => answer.as_bool() != Some(false),
            Err(thrown) => {
                self.state.thrown.borrow_mut().get_or_insert(thrown);
                false
            }
        }
    }
}

impl Progress for Callback {
    fn on_stage_start(&self, stage: Stage) {
        self.state.stage.set(Some(stage));
        self.call(stage, 0, 1);
    }

    fn on_stage_end(&self, stage: Stage) {
        self.call(stage, 1, 1);
    }

    fn step(&self, stage: Stage, done: u32, total: u32) -> bool {
        if !self.cancelled.load(Ordering::Relaxed) && self.state.valid() && !self.call(stage, done, total) {
            self.cancelled.store(true, Ordering::Relaxed);
        }
        !self.cancelled.load(Ordering::Relaxed)
    }
}
