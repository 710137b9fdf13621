//! Functions that are alike in both versions, by their names in each.

/// Functions of an instance alone.
macro_rules! verbs {
    ($($function:ident => $verb:ident),* $(,)?) => {$(
        #[unsafe(no_mangle)]
        extern "C" fn $function(handle: Handle) -> c_int {
            call(handle, stringify!($function), Instance::$verb)
        }
    )*};
}

/// Functions that write a list.
macro_rules! lists {
    ($($function:ident => $verb:ident),* $(,)?) => {$(
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $function(handle: Handle, values: *mut f64, count: usize) -> c_int {
            // SAFETY: as FMI promises: room for `count` values.
            call(handle, stringify!($function), |instance| instance.$verb(unsafe { list_mut(values, count) }?))
        }
    )*};
}

/// Functions of saved states.
macro_rules! state_functions {
    (get: $get:ident, set: $set:ident, free: $free:ident, size: $size:ident, serialize: $serialize:ident,
     deserialize: $deserialize:ident $(,)?) => {
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $get(handle: Handle, state: *mut Handle) -> c_int {
            call(handle, stringify!($get), |instance| {
                // SAFETY: as FMI promises: room for a handle.
                let into = unsafe { list_mut(state, 1) }?;
                let saved = instance.save()?;
                // A state that was given is overwritten.
                free_saved(into[0]);
                into[0] = hand_out(saved);
                Ok(())
            })
        }

        #[unsafe(no_mangle)]
        extern "C" fn $set(handle: Handle, state: Handle) -> c_int {
            call(handle, stringify!($set), |instance| instance.restore(&*saved(state)?))
        }

        #[unsafe(no_mangle)]
        unsafe extern "C" fn $free(handle: Handle, state: *mut Handle) -> c_int {
            call(handle, stringify!($free), |_| {
                if !state.is_null() {
                    // SAFETY: as FMI promises: a handle.
                    let of = unsafe { list_mut(state, 1) }?;
                    free_saved(of[0]);
                    of[0] = std::ptr::null_mut();
                }
                Ok(())
            })
        }

        #[unsafe(no_mangle)]
        unsafe extern "C" fn $size(handle: Handle, state: Handle, size: *mut usize) -> c_int {
            call(handle, stringify!($size), |_| {
                // SAFETY: as FMI promises: room for a size.
                unsafe { list_mut(size, 1) }?[0] = saved(state)?.size();
                Ok(())
            })
        }

        #[unsafe(no_mangle)]
        unsafe extern "C" fn $serialize(handle: Handle, state: Handle, bytes: *mut u8, size: usize) -> c_int {
            call(handle, stringify!($serialize), |_| {
                let saved = saved(state)?.to_bytes();
                if size < saved.len() {
                    return Err(Refusal::error(format!("{size} bytes are given for a state of {}", saved.len())));
                }
                // SAFETY: as FMI promises: room for `size` bytes.
                unsafe { list_mut(bytes, saved.len()) }?.copy_from_slice(&saved);
                Ok(())
            })
        }

        #[unsafe(no_mangle)]
        unsafe extern "C" fn $deserialize(handle: Handle, bytes: *const u8, size: usize, state: *mut Handle) -> c_int {
            call(handle, stringify!($deserialize), |instance| {
                // SAFETY: as FMI promises: `size` bytes, and room for a handle.
                let (bytes, into) = unsafe { (list(bytes, size)?, list_mut(state, 1)?) };
                let saved = instance.saved_from(bytes)?;
                free_saved(into[0]);
                into[0] = hand_out(saved);
                Ok(())
            })
        }
    };
}
