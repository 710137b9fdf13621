//! Where `mjModel` and `mjData` have the fields that the plugin reads, by MuJoCo's version.
//!
//! The order of fields changes in nearly every release. The rows are made by `tools/layout.py` from the headers of the wheels,
//! where a C compiler says the offsets; a version that has no row is refused by its number, with what to do.

/// Fields of `mjModel`, by their place in [`Layout::model`].
#[derive(Clone, Copy)]
pub(crate) enum ModelField {
    SensorCount,
    Timestep,
    ActuatorPlugin,
    ActAddress,
    ActCount,
    ControlLimited,
    ControlRange,
    SensorPlugin,
    SensorAddress,
    StateAddress,
    Dynamics,
}

/// Fields of `mjData`, by their place in [`Layout::data`].
#[derive(Clone, Copy)]
pub(crate) enum DataField {
    Velocity,
    Act,
    Control,
    State,
    Kept,
    Sensor,
    Length,
    Rate,
    Force,
    Moment,
    MomentCount,
    MomentStart,
    MomentColumns,
}

/// Offsets in bytes, of one version.
pub(crate) struct Layout {
    version: i32,
    /// Size of the numbers of entries.
    pub(crate) count_size: usize,
    /// How many actuators there are.
    pub(crate) actuators: usize,
    /// Arrays of the addresses of an actuator's first control and force; before 3.11 they are its number.
    pub(crate) addresses: Option<[usize; 2]>,
    model: [usize; 11],
    data: [usize; 13],
    /// Kinds of objects that have names: actuator, sensor, plugin.
    pub(crate) objects: [i32; 3],
    /// The stage at which sensors are computed: that of accelerations, after the forces.
    pub(crate) stage: i32,
}

impl Layout {
    pub(crate) fn model(&self, field: ModelField) -> usize {
        self.model[field as usize]
    }

    pub(crate) fn data(&self, field: DataField) -> usize {
        self.data[field as usize]
    }
}

/// The layout of a version.
pub(crate) fn of(version: i32) -> Option<&'static Layout> {
    ALL.iter().find(|layout| layout.version == version)
}

/// All versions, the oldest first.
pub(crate) fn versions() -> Vec<i32> {
    ALL.iter().map(|layout| layout.version).collect()
}

/// What is said of a version that is not known.
pub(crate) fn unknown(version: i32) -> String {
    let [first, last] = [ALL.first(), ALL.last()].map(|layout| layout.map_or(0, |layout| layout.version));
    format!(
        "MuJoCo {} is not among the {} versions from {} to {} that this plugin knows; install one of those, such as \
         `pip install mujoco=={}`, or step the plant alongside MuJoCo with mckibben.mujoco.Driver",
        words(version),
        ALL.len(),
        words(first),
        words(last),
        words(last)
    )
}

/// A version in words: 337 is 3.3.7, 3005000 is 3.5.0.
fn words(version: i32) -> String {
    match version {
        1_000_000.. => format!("{}.{}.{}", version / 1_000_000, version / 1000 % 1000, version % 1000),
        _ => format!("{}.{}.{}", version / 100, version / 10 % 10, version % 10),
    }
}

#[expect(
    clippy::too_many_arguments,
    reason = "they are the columns of the table, in the order of the script that makes it"
)]
const fn row(
    version: i32,
    count_size: usize,
    actuators: usize,
    addresses: Option<[usize; 2]>,
    model: [usize; 11],
    data: [usize; 13],
    objects: [i32; 3],
    stage: i32,
) -> Layout {
    Layout { version, count_size, actuators, addresses, model, data, objects, stage }
}

#[rustfmt::skip]
const ALL: &[Layout] = &[
    row(327, 4, 8, None, [176, 336, 3896, 3744, 3752, 3768, 3824, 4000, 3968, 4016, 3712], [161664, 161672, 161696, 161688, 161784, 161768, 162064, 162168, 162392, 162096, 162072, 162080, 162088], [19, 20, 25], 3), // 3.2.7
    row(330, 4, 8, None, [192, 352, 4032, 3880, 3888, 3904, 3960, 4136, 4104, 4152, 3848], [161664, 161672, 161696, 161688, 161784, 161768, 162064, 162168, 162392, 162096, 162072, 162080, 162088], [19, 20, 25], 3), // 3.3.0
    row(331, 4, 8, None, [192, 352, 4064, 3912, 3920, 3936, 3992, 4168, 4136, 4184, 3880], [161664, 161672, 161696, 161688, 161784, 161768, 162064, 162168, 162424, 162096, 162072, 162080, 162088], [19, 20, 25], 3), // 3.3.1
    row(332, 4, 8, None, [192, 352, 4064, 3912, 3920, 3936, 3992, 4168, 4136, 4184, 3880], [161656, 161664, 161688, 161680, 161776, 161760, 162056, 162160, 162416, 162088, 162064, 162072, 162080], [19, 20, 25], 3), // 3.3.2
    row(333, 4, 8, None, [192, 352, 4112, 3960, 3968, 3984, 4040, 4216, 4184, 4232, 3928], [161664, 161672, 161696, 161688, 161784, 161768, 162064, 162176, 162400, 162096, 162072, 162080, 162088], [19, 20, 25], 3), // 3.3.3
    row(334, 4, 8, None, [196, 352, 4152, 4000, 4008, 4024, 4080, 4256, 4224, 4272, 3968], [161664, 161672, 161696, 161688, 161784, 161768, 162064, 162176, 162400, 162096, 162072, 162080, 162088], [19, 20, 25], 3), // 3.3.4
    row(335, 4, 8, None, [196, 352, 4160, 4008, 4016, 4032, 4088, 4272, 4240, 4288, 3976], [161664, 161672, 161696, 161688, 161784, 161768, 162072, 162176, 162400, 162104, 162080, 162088, 162096], [19, 20, 25], 3), // 3.3.5
    row(336, 4, 8, None, [216, 352, 4168, 4016, 4024, 4040, 4096, 4280, 4248, 4296, 3984], [161664, 161672, 161696, 161688, 161784, 161768, 162072, 162176, 162296, 162104, 162080, 162088, 162096], [19, 20, 25], 3), // 3.3.6
    row(337, 4, 8, None, [216, 352, 4160, 4008, 4016, 4032, 4088, 4272, 4240, 4288, 3976], [161664, 161672, 161696, 161688, 161784, 161768, 162072, 162176, 162296, 162104, 162080, 162088, 162096], [19, 20, 25], 3), // 3.3.7
    row(340, 4, 8, None, [216, 352, 4232, 4080, 4088, 4104, 4160, 4344, 4312, 4360, 4048], [161680, 161688, 161712, 161704, 161808, 161784, 162096, 162240, 162360, 162128, 162104, 162112, 162120], [19, 20, 25], 3), // 3.4.0
    row(3005000, 8, 16, None, [448, 712, 4712, 4536, 4544, 4584, 4640, 4856, 4792, 4872, 4504], [161680, 161688, 161720, 161712, 161816, 161792, 162096, 162240, 162360, 162128, 162104, 162112, 162120], [19, 20, 25], 3), // 3.5.0
    row(3006000, 8, 16, None, [456, 720, 4744, 4568, 4576, 4616, 4672, 4888, 4824, 4904, 4536], [161680, 161688, 161720, 161712, 161816, 161792, 162072, 162216, 162336, 162104, 162080, 162088, 162096], [19, 20, 25], 3), // 3.6.0
    row(3007000, 8, 16, None, [456, 720, 4816, 4640, 4648, 4688, 4744, 4960, 4896, 4976, 4584], [161672, 161680, 161712, 161704, 161808, 161784, 162064, 162208, 162328, 162096, 162072, 162080, 162088], [19, 20, 25], 3), // 3.7.0
    row(3008000, 8, 16, None, [464, 728, 4848, 4672, 4680, 4720, 4776, 4992, 4928, 5008, 4616], [161672, 161680, 161712, 161704, 161808, 161784, 162064, 162208, 162328, 162096, 162072, 162080, 162088], [19, 20, 25], 3), // 3.8.0
    row(3008001, 8, 16, None, [472, 736, 4864, 4688, 4696, 4736, 4792, 5008, 4944, 5024, 4632], [161672, 161680, 161712, 161704, 161808, 161784, 162064, 162208, 162328, 162096, 162072, 162080, 162088], [19, 20, 25], 3), // 3.8.1
    row(3009000, 8, 16, None, [472, 736, 4856, 4680, 4688, 4728, 4784, 5000, 4936, 5016, 4624], [161680, 161688, 161720, 161712, 161816, 161792, 162072, 162216, 162336, 162104, 162080, 162088, 162096], [19, 20, 25], 3), // 3.9.0
    row(3010000, 8, 16, None, [472, 736, 4856, 4680, 4688, 4728, 4784, 5000, 4936, 5016, 4624], [160672, 160680, 160712, 160704, 160808, 160784, 161064, 161208, 161328, 161096, 161072, 161080, 161088], [19, 20, 25], 3), // 3.10.0
    row(3011000, 8, 24, Some([4768, 4792]), [504, 792, 4952, 4808, 4816, 4976, 4984, 5160, 5096, 5176, 4744], [160688, 160696, 160728, 160720, 160824, 160800, 161088, 161224, 161352, 161120, 161096, 161104, 161112], [19, 20, 25], 3), // 3.11.0
    row(3012000, 8, 24, Some([4784, 4808]), [504, 792, 4968, 4824, 4832, 4992, 5000, 5176, 5112, 5192, 4760], [160688, 160696, 160728, 160720, 160824, 160800, 161088, 161224, 161352, 161120, 161096, 161104, 161112], [19, 20, 25], 3), // 3.12.0
    row(3013000, 8, 24, Some([4792, 4816]), [504, 792, 4976, 4832, 4840, 5000, 5008, 5184, 5120, 5200, 4768], [160696, 160704, 160736, 160728, 160832, 160808, 161096, 161232, 161360, 161128, 161104, 161112, 161120], [19, 20, 25], 3), // 3.13.0
    row(3014000, 8, 24, Some([4792, 4816]), [504, 792, 4976, 4832, 4840, 5000, 5008, 5184, 5120, 5200, 4768], [160696, 160704, 160736, 160728, 160832, 160808, 161112, 161248, 161376, 161144, 161120, 161128, 161136], [19, 20, 25], 3), // 3.14.0
    row(3015000, 8, 24, Some([4752, 4776]), [496, 784, 4936, 4792, 4800, 4960, 4968, 5144, 5080, 5160, 4728], [160696, 160704, 160736, 160728, 160832, 160808, 161136, 161272, 161400, 161168, 161144, 161152, 161160], [19, 20, 25], 3), // 3.15.0
    row(3016000, 8, 24, Some([4768, 4792]), [504, 792, 4952, 4808, 4816, 4976, 4984, 5160, 5096, 5176, 4744], [160696, 160704, 160736, 160728, 160832, 160808, 161136, 161272, 161400, 161168, 161144, 161152, 161160], [19, 20, 25], 3), // 3.16.0
    row(3017000, 8, 24, Some([4776, 4800]), [504, 792, 4960, 4816, 4824, 4984, 4992, 5168, 5104, 5184, 4752], [160696, 160704, 160736, 160728, 160832, 160808, 161136, 161272, 161400, 161168, 161144, 161152, 161160], [19, 20, 25], 3), // 3.17.0
    row(4000000, 8, 24, Some([4800, 4824]), [496, 792, 4984, 4840, 4848, 5008, 5016, 5192, 5128, 5208, 4776], [160696, 160704, 160744, 160736, 160840, 160816, 161152, 161288, 161416, 161184, 161160, 161168, 161176], [19, 20, 25], 3), // 4.0.0
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_rise_and_are_said_in_words() {
        assert!(versions().windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!((words(337), words(3_017_000)), ("3.3.7".to_owned(), "3.17.0".to_owned()));
        assert!(of(4_000_000).is_some() && of(9_000_000).is_none());
        assert!(unknown(9_000_000).contains("MuJoCo 9.0.0"));
    }
}
