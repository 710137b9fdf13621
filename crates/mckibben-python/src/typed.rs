//! Python objects with the types that the stubs give them.

use numpy::{AllowTypeChange, PyArrayLike1, PyReadonlyArray1, PyReadwriteArray1};
use pyo3::inspect::PyStaticExpr;
use pyo3::prelude::*;
use pyo3::types::PyMapping;
use pyo3::{type_hint_identifier as name, type_hint_subscript as of, type_hint_union};
use std::convert::Infallible;

const ANY: PyStaticExpr = name!("typing", "Any");
const STR: PyStaticExpr = name!("builtins", "str");
const FLOAT: PyStaticExpr = name!("builtins", "float");
const DICT: PyStaticExpr = name!("builtins", "dict");
const ARRAY: PyStaticExpr = name!("numpy.typing", "NDArray");

macro_rules! typed {
    ($($(#[$about:meta])* $name:ident = $hint:expr;)*) => { $(
        $(#[$about])*
        pub(crate) struct $name<'py>(pub(crate) Bound<'py, PyAny>);

        impl<'py> IntoPyObject<'py> for $name<'py> {
            type Target = PyAny;
            type Output = Bound<'py, PyAny>;
            type Error = Infallible;
            const OUTPUT_TYPE: PyStaticExpr = $hint;

            fn into_pyobject(self, _: Python<'py>) -> Result<Self::Output, Self::Error> {
                Ok(self.0)
            }
        }
    )* };
}

typed! {
    /// An array of numbers.
    Numbers = of!(ARRAY, name!("numpy", "float64"));
    /// An array of words.
    Words = of!(ARRAY, name!("numpy", "str_"));
    /// An array of either.
    Column = of!(ARRAY, ANY);
    /// An array of complex numbers.
    Complex = of!(ARRAY, name!("numpy", "complex128"));
    /// A matrix of numbers.
    Matrix = of!(ARRAY, name!("numpy", "float64"));
    /// Arrays of numbers by their names.
    Numbered = of!(DICT, STR, of!(ARRAY, name!("numpy", "float64")));
    /// Arrays by their names.
    Columns = of!(DICT, STR, of!(ARRAY, ANY));
    /// Values by their names.
    Row = of!(DICT, STR, type_hint_union!(FLOAT, STR));
    /// Numbers by their names.
    Point = of!(DICT, STR, FLOAT);
    /// Words by their names.
    Names = of!(DICT, STR, STR);
    /// The sections of a scenario.
    Sections = of!(DICT, STR, ANY);
    /// What an object is made of, for pickling.
    Parts = of!(name!("builtins", "tuple"), ANY, name!("builtins", "..."));
    /// A data frame of pandas.
    Pandas = name!("pandas", "DataFrame");
    /// A data frame of Polars.
    Polars = name!("polars", "DataFrame");
    /// A function.
    Function = of!(name!("collections.abc", "Callable"), name!("builtins", "..."), ANY);
    /// A figure of Matplotlib.
    Figure = name!("matplotlib.figure", "Figure");
}

/// An array that the caller owns, read or written in place.
pub(crate) struct Given<A>(pub(crate) A);

impl<'a, 'py, A: FromPyObject<'a, 'py>> FromPyObject<'a, 'py> for Given<A> {
    type Error = A::Error;
    const INPUT_TYPE: PyStaticExpr = of!(ARRAY, name!("numpy", "float64"));

    fn extract(array: Borrowed<'a, 'py, PyAny>) -> Result<Self, Self::Error> {
        array.extract().map(Self)
    }
}

/// Places in an array, as NumPy counts them.
pub(crate) struct Rows<'py>(pub(crate) PyReadonlyArray1<'py, i64>);

impl<'a, 'py> FromPyObject<'a, 'py> for Rows<'py> {
    type Error = PyErr;
    const INPUT_TYPE: PyStaticExpr = of!(ARRAY, name!("numpy", "int64"));

    fn extract(rows: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        Ok(Self(rows.extract()?))
    }
}

/// Flags that are written in place.
pub(crate) struct Flags<'py>(pub(crate) PyReadwriteArray1<'py, bool>);

impl<'a, 'py> FromPyObject<'a, 'py> for Flags<'py> {
    type Error = PyErr;
    const INPUT_TYPE: PyStaticExpr = of!(ARRAY, name!("numpy", "bool_"));

    fn extract(flags: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        Ok(Self(flags.extract()?))
    }
}

/// Numbers in a sequence or an array of any type and layout.
pub(crate) struct Sequence(pub(crate) Vec<f64>);

impl<'a, 'py> FromPyObject<'a, 'py> for Sequence {
    type Error = PyErr;
    const INPUT_TYPE: PyStaticExpr = name!("numpy.typing", "ArrayLike");

    fn extract(numbers: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let array: PyArrayLike1<'py, f64, AllowTypeChange> = numbers.extract()?;
        Ok(Self(array.as_array().iter().copied().collect()))
    }
}

/// Values of a scenario by their keys or sections.
pub(crate) struct Values<'py>(pub(crate) Bound<'py, PyMapping>);

impl<'a, 'py> FromPyObject<'a, 'py> for Values<'py> {
    type Error = PyErr;
    const INPUT_TYPE: PyStaticExpr = of!(name!("collections.abc", "Mapping"), STR, ANY);

    fn extract(values: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        Ok(Self(values.cast::<PyMapping>()?.to_owned()))
    }
}
