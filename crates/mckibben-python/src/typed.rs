//! Python objects with the types that the stubs give them.

use crate::exceptions::{OrException, exception};
use crate::python;
use mckibben_batch::Precision;
use mckibben_run::failure::Failure;
use mckibben_run::quantities;
use numpy::ndarray::Dimension;
use numpy::{
    AllowTypeChange, BorrowError, Element, Ix1, Ix2, PyArray, PyArray1, PyArrayLike1, PyArrayMethods, PyReadonlyArray,
    PyReadonlyArrayDyn, PyReadwriteArray, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::conversion::FromPyObjectOwned;
use pyo3::exceptions::PyTypeError;
use pyo3::inspect::{PyStaticConstant, PyStaticExpr};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyFloat, PyInt, PyMapping, PyString};
use pyo3::{type_hint_identifier as name, type_hint_subscript as of, type_hint_union};
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::marker::PhantomData;

const ANY: PyStaticExpr = name!("typing", "Any");
const STR: PyStaticExpr = name!("builtins", "str");
const FLOAT: PyStaticExpr = name!("builtins", "float");
const BOOL: PyStaticExpr = name!("builtins", "bool");
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
    /// Values by their names: numbers, and words in a few columns. A union would make users convert each number before they reckon.
    Row = of!(DICT, STR, ANY);
    /// Numbers by their names.
    Point = of!(DICT, STR, FLOAT);
    /// What holds, by its names: a word, a number, or whether.
    Facts = of!(DICT, STR, type_hint_union!(STR, FLOAT, BOOL));
    /// Words by their names.
    Names = of!(DICT, STR, STR);
    /// Words one after the other.
    Listed = of!(name!("collections.abc", "Iterator"), STR);
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
    /// An object of a package that need not be there.
    Object = ANY;
    /// What a run settles to.
    Settled = name!("mckibben._results", "Settled");
    /// What a run came to.
    Summary = name!("mckibben._results", "Summary");
    /// The modes of a linear model.
    Modes = name!("mckibben._results", "Modes");
    /// How far a linear model holds.
    Validity = name!("mckibben._results", "Validity");
    /// A figure of Matplotlib.
    Figure = name!("matplotlib.figure", "Figure");
}

/// Declares arguments that take one of a few words. The function that takes one refuses every other.
macro_rules! words {
    ($($(#[$about:meta])* $name:ident = $($word:literal)|+;)*) => { $(
        $(#[$about])*
        #[derive(Clone, Debug)]
        pub(crate) struct $name(pub(crate) String);

        impl $name {
            pub(crate) const HINT: PyStaticExpr = of!(
                name!("typing", "Literal"),
                $(PyStaticExpr::Constant { value: PyStaticConstant::Str($word) }),+
            );
        }

        impl From<&str> for $name {
            fn from(word: &str) -> Self {
                Self(word.to_owned())
            }
        }

        impl<'a, 'py> FromPyObject<'a, 'py> for $name {
            type Error = PyErr;
            const INPUT_TYPE: PyStaticExpr = Self::HINT;

            fn extract(word: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
                word.extract().map(Self)
            }
        }

        impl<'py> IntoPyObject<'py> for $name {
            type Target = PyString;
            type Output = Bound<'py, PyString>;
            type Error = Infallible;
            const OUTPUT_TYPE: PyStaticExpr = Self::HINT;

            fn into_pyobject(self, py: Python<'py>) -> Result<Self::Output, Self::Error> {
                Ok(PyString::new(py, &self.0))
            }
        }
    )* };
}

words! {
    /// Meaning of an action.
    ActionWord = "duty" | "request" | "position" | "set-point";
    /// Horizontal axis of the figure of a run.
    AxisWord = "time" | "length";
    /// Actuator of an antagonistic joint.
    MemberWord = "agonist" | "antagonist";
    /// Numbers that the lanes of a batch hold.
    PrecisionWord = "double" | "single";
    /// Open ports of a valve.
    PortsWord = "closed" | "supply" | "exhaust" | "supply+exhaust";
    /// Request of a valve with poppets.
    RequestWord = "fill" | "hold" | "exhaust";
}

impl PrecisionWord {
    pub(crate) fn read(&self) -> Result<Precision, Failure> {
        match self.0.as_str() {
            "double" => Ok(Precision::Double),
            "single" => Ok(Precision::Single),
            other => {
                let title = format!("precision = \"{other}\" is not known");
                Err(Failure::input(title, "choose \"double\" or \"single\""))
            }
        }
    }

    pub(crate) fn of(precision: Precision) -> Self {
        Self::from(if precision == Precision::Single { "single" } else { "double" })
    }
}

/// Entries of arrays that are read or written in place.
pub(crate) trait Entry: Element + Copy {
    /// NumPy's name of them.
    const NAME: &'static str;
    const HINT: PyStaticExpr;
}

impl Entry for f64 {
    const NAME: &'static str = "float64";
    const HINT: PyStaticExpr = of!(ARRAY, name!("numpy", "float64"));
}

impl Entry for i64 {
    const NAME: &'static str = "int64";
    const HINT: PyStaticExpr = of!(ARRAY, name!("numpy", "int64"));
}

impl Entry for bool {
    const NAME: &'static str = "bool";
    const HINT: PyStaticExpr = of!(ARRAY, name!("numpy", "bool_"));
}

/// An array that the caller owns: used in its place by [`Given::read`] and [`Given::write`], copied by [`Given::copied`].
///
/// These are the only ways to its entries, so an array whose rows do not follow each other in memory, such as a transposed one,
/// is never taken in the order of the memory. They know the name of its argument.
pub(crate) struct Given<'py, T = f64, D = Ix1> {
    array: Bound<'py, PyAny>,
    of: PhantomData<(T, D)>,
}

/// A table that the caller owns.
pub(crate) type Table<'py> = Given<'py, f64, Ix2>;
/// Places in an array, as NumPy counts them.
pub(crate) type Rows<'py> = Given<'py, i64, Ix1>;
/// Flags that are written in place.
pub(crate) type Flags<'py> = Given<'py, bool, Ix1>;

impl<'a, 'py, T: Entry, D> FromPyObject<'a, 'py> for Given<'py, T, D> {
    type Error = Infallible;
    const INPUT_TYPE: PyStaticExpr = T::HINT;

    fn extract(array: Borrowed<'a, 'py, PyAny>) -> Result<Self, Infallible> {
        Ok(Self { array: array.to_owned(), of: PhantomData })
    }
}

impl<'py, T: Entry, D: Dimension> Given<'py, T, D> {
    /// Borrows the array to read it in its place. It is C-contiguous: its slice has the entries row by row.
    pub(crate) fn read(&self, name: &str) -> PyResult<PyReadonlyArray<'py, T, D>> {
        let array = self.named(name)?.try_readonly().map_err(|error| Self::refused(name, &error))?;
        let remedy = format!("give numpy.ascontiguousarray({name})");
        self.in_place(name, array.is_c_contiguous() && array.as_slice().is_ok(), &remedy).map(|()| array)
    }

    /// Borrows the array to write to it in its place. It is C-contiguous, as that of [`Given::read`].
    pub(crate) fn write(&self, name: &str) -> PyResult<PyReadwriteArray<'py, T, D>> {
        let array = self.named(name)?.try_readwrite().map_err(|error| Self::refused(name, &error))?;
        let remedy =
            "give an array of numpy.zeros, or the result of numpy.ascontiguousarray, and read the results there";
        self.in_place(name, array.is_c_contiguous() && array.as_slice().is_ok(), remedy).map(|()| array)
    }

    /// Copies the entries row by row, from an array of any layout, with the lengths of its dimensions.
    pub(crate) fn copied(&self, name: &str) -> PyResult<Copied<T>> {
        let array = self.named(name)?.try_readonly().map_err(|error| Self::refused(name, &error))?;
        // Entries at odd addresses cannot be read one by one.
        let is_aligned = self.array.getattr("flags")?.getattr("aligned")?.is_truthy()?;
        if !is_aligned {
            return Err(Self::unaligned(name));
        }
        Ok(Copied { entries: array.as_array().iter().copied().collect(), shape: array.shape().to_vec() })
    }

    /// Refuses an array that cannot be used in its place.
    fn in_place(&self, name: &str, can_be: bool, remedy: &str) -> PyResult<()> {
        if can_be {
            return Ok(());
        }
        if self.named(name)?.is_c_contiguous() {
            return Err(Self::unaligned(name));
        }
        let title = format!("`{name}` is not C-contiguous: its entries do not follow each other in memory row by row");
        Err(exception(&Failure::input(title, remedy)))
    }

    fn unaligned(name: &str) -> PyErr {
        exception(&Failure::input(
            format!("`{name}` is not aligned in memory: its entries are not at multiples of their size"),
            format!("give {name}.copy()"),
        ))
    }

    /// The array under the name of its argument. What the mask of one hides is no entry.
    fn named(&self, name: &str) -> PyResult<&Bound<'py, PyArray<T, D>>> {
        if !self.array.is_exact_instance_of::<PyUntypedArray>()
            && let Some(mask) = self.array.getattr_opt("mask")?
            && mask.call_method0("any")?.is_truthy()?
        {
            let title = format!("`{name}` is a masked array whose mask hides entries");
            return Err(exception(&Failure::input(
                title,
                format!("give {name}.filled(…), with numbers in their place"),
            )));
        }
        self.array.cast().map_err(|_| {
            let of = |count: usize| format!("{count} dimension{}", if count == 1 { "" } else { "s" });
            let what = match self.array.cast::<PyUntypedArray>() {
                Ok(array) => format!("an array of {} with {}", array.dtype(), of(array.ndim())),
                Err(_) => format!("of type {}", kind(&self.array)),
            };
            let remedy = format!("give a NumPy array of {} with {}", T::NAME, of(D::NDIM.unwrap_or_default()));
            PyTypeError::new_err(format!("`{name}` is {what}; {remedy}"))
        })
    }

    fn refused(name: &str, error: &BorrowError) -> PyErr {
        exception(&match error {
            BorrowError::NotWriteable => Failure::input(
                format!("`{name}` cannot be written to"),
                "give an array of your own, such as one of numpy.zeros",
            ),
            _ => Failure::input(
                format!("`{name}` shares memory with another argument, or another thread works on it"),
                "give each argument, and each thread, a separate array",
            ),
        })
    }
}

/// Entries of an array in C order, in which the last index varies fastest, and the lengths of its dimensions.
pub(crate) struct Copied<T = f64> {
    pub(crate) entries: Vec<T>,
    pub(crate) shape: Vec<usize>,
}

/// The name of an object's type.
pub(crate) fn kind(object: &Bound<'_, PyAny>) -> String {
    object.get_type().name().map_or_else(|_| "object".to_owned(), |name| name.to_string())
}

/// Items of a sequence, however many it says it has.
pub(crate) struct Items<T>(pub(crate) Vec<T>);

/// Items of a sequence at most.
const MOST_ITEMS: usize = 2_000_000;

impl<'a, 'py, T: FromPyObjectOwned<'py>> FromPyObject<'a, 'py> for Items<T> {
    type Error = PyErr;
    const INPUT_TYPE: PyStaticExpr = of!(name!("collections.abc", "Sequence"), T::INPUT_TYPE);

    fn extract(items: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if items.is_instance_of::<PyString>() || items.is_instance_of::<PyMapping>() {
            return Err(PyTypeError::new_err(format!("a list is wanted and no {}", kind(&items))));
        }
        let mut all = Vec::new();
        // What it says of its length may be wrong, and room for that many would be made.
        for item in items.try_iter()? {
            if all.len() == MOST_ITEMS {
                let title = format!("a sequence has more than {MOST_ITEMS} items");
                return Err(exception(&Failure::input(title, "give fewer")));
            }
            all.push(item?.extract::<T>().map_err(Into::into)?);
        }
        Ok(Self(all))
    }
}

/// Texts in a sequence. It is read by [`Texts::read`], which knows the name of its argument: one text is no list of its letters.
pub(crate) struct Texts<'py>(Option<Bound<'py, PyAny>>);

impl Texts<'_> {
    /// No texts.
    pub(crate) const NONE: Self = Self(None);

    /// The texts of the argument of a name.
    pub(crate) fn read(&self, name: &str) -> PyResult<Vec<String>> {
        let Some(given) = &self.0 else { return Ok(Vec::new()) };
        if given.is_instance_of::<PyString>() {
            let remedy = format!("give [{}]", given.repr()?);
            return Err(PyTypeError::new_err(format!("`{name}`: a list is wanted and no str; {remedy}")));
        }
        given.extract::<Items<String>>().map(|items| items.0).map_err(|error| {
            match error.is_instance_of::<PyTypeError>(given.py()) {
                true => PyTypeError::new_err(format!("`{name}`: {}; give a list of texts", error.value(given.py()))),
                false => error,
            }
        })
    }
}

impl<'a, 'py> FromPyObject<'a, 'py> for Texts<'py> {
    type Error = Infallible;
    const INPUT_TYPE: PyStaticExpr = of!(name!("collections.abc", "Sequence"), STR);

    fn extract(texts: Borrowed<'a, 'py, PyAny>) -> Result<Self, Infallible> {
        Ok(Self(Some(texts.to_owned())))
    }
}

/// The name of a column.
pub(crate) struct Name(pub(crate) String);

impl<'a, 'py> FromPyObject<'a, 'py> for Name {
    type Error = PyErr;
    const INPUT_TYPE: PyStaticExpr = STR;

    fn extract(name: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        name.extract().map(Self).map_err(|_| {
            let what = kind(&name);
            PyTypeError::new_err(format!(
                "columns have names and no places: give text such as \"length_m\" and no {what}"
            ))
        })
    }
}

/// A quantity: a number in SI, or text with its unit. It is read by [`Quantity::read`], [`Quantity::si`] and [`Quantity::given`],
/// which know the name of its argument.
pub(crate) enum Quantity<'py> {
    Number(f64),
    /// What is no float of Python.
    Other(Bound<'py, PyAny>),
}

/// What an argument of a quantity is.
pub(crate) enum Value {
    Number(f64),
    Text(String),
}

/// How text of a quantity is read: what it is, its SI unit, and an example.
pub(crate) type Measured = [&'static str; 3];

pub(crate) const LENGTH: Measured = ["length", "m", "85 mm"];
pub(crate) const VELOCITY: Measured = ["velocity", "m/s", "10 mm/s"];
pub(crate) const TIME: Measured = ["time", "s", "1 ms"];
pub(crate) const PRESSURE: Measured = ["pressure", "Pa", "2 bar"];
pub(crate) const FREQUENCY: Measured = ["frequency", "Hz", "25 Hz"];
pub(crate) const FORCE: Measured = ["force", "N", "20 N"];
pub(crate) const SHARE: Measured = ["share", "%", "40 %"];

impl<'a, 'py> FromPyObject<'a, 'py> for Quantity<'py> {
    type Error = Infallible;
    const INPUT_TYPE: PyStaticExpr = type_hint_union!(FLOAT, STR);

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> Result<Self, Infallible> {
        // Steps take several, so what is usual comes first.
        Ok(given.cast_exact::<PyFloat>().map_or_else(|_| Self::Other(given.to_owned()), |it| Self::Number(it.value())))
    }
}

impl Quantity<'_> {
    /// Whether the argument of a name is a number or text. Truth values and `None` are neither.
    pub(crate) fn given(&self, name: &str) -> PyResult<Value> {
        let given = match self {
            Self::Number(number) => return Ok(Value::Number(*number)),
            Self::Other(given) => given,
        };
        if let Ok(text) = given.extract::<String>() {
            return Ok(Value::Text(text));
        }
        match given.extract::<f64>() {
            Ok(number) if !is_truth(given) => Ok(Value::Number(number)),
            _ => {
                let title =
                    format!("`{name}` is of type {}, and is to be a number in SI or text with its unit", kind(given));
                Err(PyTypeError::new_err(title))
            }
        }
    }

    /// The argument of a name, from text as `read` takes it. Numbers that are not finite are refused.
    pub(crate) fn read<T>(
        self,
        name: &str,
        read: impl FnOnce(&str) -> Result<T, String>,
        of: impl FnOnce(f64) -> T,
    ) -> PyResult<T> {
        let read = match self.given(name)? {
            Value::Number(number) if number.is_finite() => Ok(of(number)),
            Value::Number(number) => {
                Err(Failure::input(format!("{name} = {number:?} is no finite number"), "give a finite number"))
            }
            Value::Text(text) => read(&text).map_err(|why| of_text(name, &why)),
        };
        read.or_exception()
    }

    /// The argument of a name in SI. Its caller refuses what is out of its range.
    pub(crate) fn si(self, name: &str, measured: Measured) -> PyResult<f64> {
        match self.given(name)? {
            Value::Number(number) => Ok(number),
            Value::Text(text) => si_of_text(name, &text, measured).or_exception(),
        }
    }
}

/// The number in SI of text in the argument of a name.
pub(crate) fn si_of_text(name: &str, text: &str, [what, unit, example]: Measured) -> Result<f64, Failure> {
    quantities::read(text, what, unit, example).map_err(|why| of_text(name, &why))
}

fn of_text(name: &str, why: &str) -> Failure {
    Failure::input(format!("`{name}`: {why}"), "give a number in SI, or text with a unit of this quantity")
}

/// Whether an object is a truth value of Python or NumPy, which count as numbers there.
pub(crate) fn is_truth(given: &Bound<'_, PyAny>) -> bool {
    given.is_instance_of::<PyBool>() || matches!(kind(given).as_str(), "bool" | "bool_")
}

/// What an object is made of, for pickling: by place and by name.
pub(crate) type NewArguments<'py, P> = (P, BTreeMap<&'static str, Bound<'py, PyAny>>);

/// How many there are to be of something, `LEAST` or more.
pub(crate) struct Count<const LEAST: usize = 0>(pub(crate) usize);

impl<'a, 'py, const LEAST: usize> FromPyObject<'a, 'py> for Count<LEAST> {
    type Error = PyErr;
    const INPUT_TYPE: PyStaticExpr = name!("builtins", "int");

    fn extract(count: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        match count.extract() {
            Ok(number) if number >= LEAST && !count.is_instance_of::<PyBool>() => Ok(Self(number)),
            Err(error) if !count.is_instance_of::<PyInt>() => Err(error),
            _ => Err(exception(&Failure::input(
                format!("count = {} is out of range", shortened(&count.to_string())),
                format!("give a whole number from {LEAST} on, such as 1000"),
            ))),
        }
    }
}

/// A number whose digits do not fill the screen.
pub(crate) fn shortened(digits: &str) -> String {
    match digits.len() {
        ..=24 => digits.to_owned(),
        length => format!("{}… ({length} digits)", &digits[..8]),
    }
}

/// Numbers that the package itself gives, in a sequence or an array of any type and layout; a number counts as one. Those of a caller
/// are a [`Line`].
pub(crate) struct Sequence(pub(crate) Vec<f64>);

impl<'a, 'py> FromPyObject<'a, 'py> for Sequence {
    type Error = PyErr;
    const INPUT_TYPE: PyStaticExpr = name!("numpy.typing", "ArrayLike");

    fn extract(numbers: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let error = match numbers.extract::<PyArrayLike1<'py, f64, AllowTypeChange>>() {
            Ok(array) => return Ok(Self(array.as_array().iter().copied().collect())),
            Err(error) => error,
        };
        match numbers.cast::<PyUntypedArray>().map_or(0, |array| array.ndim()) {
            0 => numbers.extract().map(|number| Self(vec![number])).map_err(|_| error),
            dimensions => {
                let title = format!("an array with {dimensions} dimensions is given; give a number or one dimension");
                Err(PyTypeError::new_err(title))
            }
        }
    }
}

/// Numbers that a caller gives, in a sequence or an array of any type and layout; a number counts as one. They are read by
/// [`Line::read`], which knows the name of the argument.
pub(crate) struct Line<'py>(Bound<'py, PyAny>);

impl Line<'_> {
    /// The numbers of the argument of a name. Truth values, texts and what a mask hides are none.
    pub(crate) fn read(&self, name: &str) -> PyResult<Vec<f64>> {
        let given = &self.0;
        // Calls in a loop give such an array.
        if given.is_exact_instance_of::<PyUntypedArray>()
            && let Ok(array) = given.cast::<PyArray1<f64>>()
            && let Ok(array) = array.try_readonly()
            && let Ok(numbers) = array.as_slice()
        {
            return Ok(numbers.to_vec());
        }
        let numbers = python::call(given.py(), ("_arguments", "numbers_of"), (name, given))?;
        let numbers = numbers.extract::<PyReadonlyArrayDyn<'_, f64>>()?;
        match numbers.ndim() {
            0 | 1 => Ok(numbers.as_array().iter().copied().collect()),
            dimensions => Err(PyTypeError::new_err(format!(
                "`{name}` is an array with {dimensions} dimensions; give a number, or numbers in one dimension"
            ))),
        }
    }
}

impl<'a, 'py> FromPyObject<'a, 'py> for Line<'py> {
    type Error = Infallible;
    const INPUT_TYPE: PyStaticExpr = name!("numpy.typing", "ArrayLike");

    fn extract(numbers: Borrowed<'a, 'py, PyAny>) -> Result<Self, Infallible> {
        Ok(Self(numbers.to_owned()))
    }
}

/// One number. It is read by [`Single::read`], which knows the name of its argument and what takes several.
pub(crate) struct Single<'py>(Bound<'py, PyAny>);

impl Single<'_> {
    /// The number of the argument of a name; `several` says what takes more than one.
    pub(crate) fn read(&self, name: &str, several: &str) -> PyResult<f64> {
        self.0.extract().ok().filter(|_| !is_truth(&self.0)).ok_or_else(|| {
            PyTypeError::new_err(format!("`{name}` is one number, and of type {} here; {several}", kind(&self.0)))
        })
    }
}

impl<'a, 'py> FromPyObject<'a, 'py> for Single<'py> {
    type Error = Infallible;
    const INPUT_TYPE: PyStaticExpr = FLOAT;

    fn extract(number: Borrowed<'a, 'py, PyAny>) -> Result<Self, Infallible> {
        Ok(Self(number.to_owned()))
    }
}

/// Gauge pressures: numbers in Pa, or text with a unit.
pub(crate) enum GaugePressures<'py> {
    Numbers(Line<'py>),
    Text(String),
}

impl<'a, 'py> FromPyObject<'a, 'py> for GaugePressures<'py> {
    type Error = PyErr;
    const INPUT_TYPE: PyStaticExpr = type_hint_union!(name!("numpy.typing", "ArrayLike"), STR);

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        match given.extract() {
            Ok(text) => Ok(Self::Text(text)),
            Err(_) => Ok(Self::Numbers(Line(given.to_owned()))),
        }
    }
}

/// A function of Python that is called with how far work has come.
pub(crate) struct Progress<'py>(pub(crate) Bound<'py, PyAny>);

impl<'a, 'py> FromPyObject<'a, 'py> for Progress<'py> {
    type Error = PyErr;
    const INPUT_TYPE: PyStaticExpr = of!(name!("collections.abc", "Callable"), name!("builtins", "..."), ANY);

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        match given.is_callable() {
            true => Ok(Self(given.to_owned())),
            false => Err(PyTypeError::new_err(format!("a function is wanted, such as print, and no {}", kind(&given)))),
        }
    }
}

/// Axes of Matplotlib to draw into.
pub(crate) struct Axes<'py>(pub(crate) Bound<'py, PyAny>);

impl<'a, 'py> FromPyObject<'a, 'py> for Axes<'py> {
    type Error = Infallible;
    const INPUT_TYPE: PyStaticExpr = of!(name!("collections.abc", "Sequence"), name!("matplotlib.axes", "Axes"));

    fn extract(axes: Borrowed<'a, 'py, PyAny>) -> Result<Self, Infallible> {
        Ok(Self(axes.to_owned()))
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
