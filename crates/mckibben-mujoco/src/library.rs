//! MuJoCo's own functions, found in the library that is loaded in this process.

use crate::layout::{self, Layout};
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::sync::OnceLock;

/// What the plugin calls.
#[derive(Clone, Copy)]
pub(crate) struct Library {
    pub(crate) layout: &'static Layout,
    pub(crate) register_plugin: unsafe extern "C" fn(*const c_void) -> c_int,
    plugin: unsafe extern "C" fn(*const c_char, *mut c_int) -> *const c_void,
    plugin_config: unsafe extern "C" fn(*const c_void, c_int, *const c_char) -> *const c_char,
    name: unsafe extern "C" fn(*const c_void, c_int, c_int) -> *const c_char,
    warning: unsafe extern "C" fn(*const c_char, ...),
}

static LIBRARY: OnceLock<Library> = OnceLock::new();

impl Library {
    /// The library, once it has been found.
    pub(crate) fn get() -> Option<&'static Self> {
        LIBRARY.get()
    }

    /// Finds the library that is loaded, and checks its version.
    pub(crate) fn find() -> Result<&'static Self, String> {
        if let Some(found) = LIBRARY.get() {
            return Ok(found);
        }
        let handle = loaded()?;
        let symbol = |name: &CStr| -> Result<*mut c_void, String> {
            // SAFETY: the handle is of a library that is loaded, and the name ends with a zero.
            let found = unsafe { libc::dlsym(handle, name.as_ptr()) };
            if found.is_null() {
                return Err(format!("the MuJoCo that is loaded has no `{}`", name.to_string_lossy()));
            }
            Ok(found)
        };
        // SAFETY: these are MuJoCo's functions by their names, whose signatures have not changed since 3.0.
        let library = unsafe {
            let version: unsafe extern "C" fn() -> c_int = std::mem::transmute(symbol(c"mj_version")?);
            let version = version();
            let layout = layout::of(version).ok_or_else(|| layout::unknown(version))?;
            Self {
                layout,
                register_plugin: std::mem::transmute::<*mut c_void, unsafe extern "C" fn(*const c_void) -> c_int>(
                    symbol(c"mjp_registerPlugin")?,
                ),
                plugin: std::mem::transmute::<
                    *mut c_void,
                    unsafe extern "C" fn(*const c_char, *mut c_int) -> *const c_void,
                >(symbol(c"mjp_getPlugin")?),
                plugin_config: std::mem::transmute::<
                    *mut c_void,
                    unsafe extern "C" fn(*const c_void, c_int, *const c_char) -> *const c_char,
                >(symbol(c"mj_getPluginConfig")?),
                name: std::mem::transmute::<
                    *mut c_void,
                    unsafe extern "C" fn(*const c_void, c_int, c_int) -> *const c_char,
                >(symbol(c"mj_id2name")?),
                warning: std::mem::transmute::<*mut c_void, unsafe extern "C" fn(*const c_char, ...)>(symbol(
                    c"mju_warning",
                )?),
            }
        };
        Ok(LIBRARY.get_or_init(|| library))
    }

    /// Whether MuJoCo has a plugin of a name already, as where another copy of this library has been loaded.
    pub(crate) fn has_plugin(&self, name: &CStr) -> bool {
        let mut slot = -1;
        // SAFETY: the name ends with a zero, and MuJoCo writes one number.
        unsafe { !(self.plugin)(name.as_ptr(), &raw mut slot).is_null() }
    }

    /// The value of an attribute of an instance; none where the model does not give it.
    ///
    /// # Safety
    /// `model` is an `mjModel` with that instance, and outlives the text.
    pub(crate) unsafe fn attribute<'m>(&self, model: *const c_void, instance: i32, name: &CStr) -> Option<&'m str> {
        // SAFETY: MuJoCo gives a text that ends with a zero and lies in the model, or null.
        unsafe {
            let value = (self.plugin_config)(model, instance, name.as_ptr());
            (!value.is_null()).then(|| CStr::from_ptr(value))?.to_str().ok()
        }
    }

    /// The name of an object of the model, by its kind and number; empty where it has none.
    ///
    /// # Safety
    /// `model` is an `mjModel`.
    pub(crate) unsafe fn name_of(&self, model: *const c_void, kind: i32, id: usize) -> String {
        let Ok(id) = c_int::try_from(id) else { return String::new() };
        // SAFETY: as in `attribute`.
        unsafe {
            let name = (self.name)(model, kind, id);
            if name.is_null() { String::new() } else { CStr::from_ptr(name).to_string_lossy().into_owned() }
        }
    }

    /// Gives MuJoCo a warning, which it prints, logs, or hands to its user's handler.
    pub(crate) fn warn(&self, text: &str) {
        let text = CString::new(text.replace('\0', " ")).unwrap_or_default();
        // SAFETY: the format takes one text that ends with a zero.
        unsafe { (self.warning)(c"%s".as_ptr(), text.as_ptr()) }
    }
}

/// The library of MuJoCo among those that are loaded: its loader need not have made its names global.
fn loaded() -> Result<*mut c_void, String> {
    let maps = std::fs::read_to_string("/proc/self/maps").unwrap_or_default();
    let mut paths = maps.lines().filter_map(|line| line.find('/').map(|at| &line[at..]));
    let path = paths.find(|path| path.rsplit('/').next().is_some_and(|name| name.starts_with("libmujoco.so")));
    let name = path.and_then(|path| CString::new(path).ok());
    // SAFETY: the flags load nothing: they find what is loaded. A null name is the program itself, with MuJoCo linked to it.
    let handle = unsafe {
        libc::dlopen(name.as_ref().map_or(std::ptr::null(), |name| name.as_ptr()), libc::RTLD_LAZY | libc::RTLD_NOLOAD)
    };
    if handle.is_null() {
        return Err("no MuJoCo is loaded: import mujoco, or link to it, before the plugin is loaded".to_owned());
    }
    Ok(handle)
}
