//! Handles: numbers that the library gives out as pointers, each one once. Nothing is read through them, so that a pointer that
//! never was a handle, or that has been freed, is recognised without touching its memory.

use crate::{
    boundary::{catch, status},
    failure::{Failure, Result},
    status::pcmvs_status::{self, InvalidHandle, NullPointer},
};
use std::{
    any::Any,
    collections::BTreeMap,
    ptr::without_provenance_mut,
    sync::{Arc, PoisonError, RwLock},
};

/// An opaque C type. It has no values: a pointer to it is the number of a body.
pub(crate) trait Opaque {
    /// What the handle holds.
    type Body: Send + Sync + 'static;
}

/// Numbers begin here, in the upper part of the address space, where no program on the supported systems has memory of its own.
const FIRST: usize = usize::MAX / 16 * 13;
/// Distance of numbers: pointers are aligned.
const APART: usize = 16;

/// The bodies of all handles.
static HANDLES: RwLock<Handles> = RwLock::new(Handles { given: 0, bodies: BTreeMap::new() });

struct Handles {
    given: usize,
    bodies: BTreeMap<usize, Arc<dyn Any + Send + Sync>>,
}

impl Handles {
    /// A number that no living handle has. None comes again before the space of numbers is used up.
    fn next(&mut self) -> usize {
        loop {
            let number = (FIRST & !(APART - 1)).wrapping_add(self.given.wrapping_mul(APART));
            self.given += 1;
            if number != 0 && !self.bodies.contains_key(&number) {
                return number;
            }
        }
    }

    /// The body with a number, if it is of the right type.
    fn get<B: Send + Sync + 'static>(&self, number: usize) -> Result<Arc<B>> {
        let body = self.bodies.get(&number).cloned().and_then(|body| body.downcast().ok());
        body.ok_or_else(|| Failure::new(InvalidHandle, "this is not a handle of this kind, or it has been freed"))
    }
}

/// Gives a body a number.
pub(crate) fn into_handle<O: Opaque>(body: O::Body) -> *mut O {
    let body = Arc::new(body);
    let mut handles = HANDLES.write().unwrap_or_else(PoisonError::into_inner);
    let number = handles.next();
    handles.bodies.insert(number, body);
    without_provenance_mut(number)
}

/// The body of a handle. It lives on during the call even if another thread frees the handle meanwhile.
pub(crate) fn body<O: Opaque>(handle: *const O) -> Result<Arc<O::Body>> {
    if handle.is_null() {
        return Err(Failure::new(NullPointer, "the handle is NULL"));
    }
    HANDLES.read().unwrap_or_else(PoisonError::into_inner).get(handle.addr())
}

/// Frees a handle unless `idle` fails. NULL is accepted.
pub(crate) fn free<O: Opaque>(handle: *mut O, idle: impl FnOnce(&O::Body) -> Result<()>) -> pcmvs_status {
    if handle.is_null() {
        return pcmvs_status::Ok;
    }
    status(body(handle.cast_const()).and_then(|found| idle(&found)).and_then(|()| {
        let mut handles = HANDLES.write().unwrap_or_else(PoisonError::into_inner);
        let freed = handles.bodies.remove(&handle.addr());
        if handles.bodies.is_empty() {
            // An empty map may keep memory.
            handles.bodies = BTreeMap::new();
        }
        drop(handles);
        catch(|| {
            drop(freed);
            Ok(())
        })
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    struct OpaqueNumber;
    struct OpaqueText;

    impl Opaque for OpaqueNumber {
        type Body = u32;
    }

    impl Opaque for OpaqueText {
        type Body = &'static str;
    }

    fn refused<O: Opaque>(handle: *const O) -> Option<pcmvs_status> {
        body(handle).err().map(|failure| failure.status)
    }

    #[test]
    fn what_is_no_handle_is_refused_without_being_read() {
        let handle = into_handle::<OpaqueNumber>(7);
        assert_eq!(*body(handle.cast_const()).unwrap(), 7);
        assert_eq!(refused(handle.cast::<OpaqueText>().cast_const()), Some(InvalidHandle), "another kind");
        for number in [1, 8, 16, 4096, usize::MAX, handle.addr() + 1, handle.addr() ^ (1 << 20)] {
            assert_eq!(refused(without_provenance_mut::<OpaqueNumber>(number).cast_const()), Some(InvalidHandle));
        }
        assert_eq!(refused(std::ptr::null::<OpaqueNumber>()), Some(NullPointer));
        assert_eq!(free(handle, |_| Err(Failure::new(pcmvs_status::Busy, ""))), pcmvs_status::Busy);
        assert_eq!(free(handle, |_| Ok(())), pcmvs_status::Ok);
        assert_eq!(free(handle, |_| Ok(())), InvalidHandle, "freed twice");
        // Numbers are not used again.
        let count = if cfg!(miri) { 20 } else { 1000 };
        let others: Vec<_> = (0..count).map(into_handle::<OpaqueNumber>).collect();
        assert_eq!(refused(handle.cast_const()), Some(InvalidHandle));
        others.into_iter().for_each(|handle| assert_eq!(free(handle, |_| Ok(())), pcmvs_status::Ok));
    }
}
