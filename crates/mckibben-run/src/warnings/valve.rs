//! Valves that never open or never close under a command of pulses: PWM, or a table of requests.
//!
//! A pulse that is shorter than the delay of its path does not move the poppet, and neither does a pause that is shorter than the
//! delay of the way back. One pulse, or pause, that is long enough is enough. One that equals the delay but for rounding moves it.

use super::{Parts, Warning, compared};
use crate::quantities::given;
use mckibben::control::Sampling;
use mckibben::internals::SIMULTANEOUS;
use mckibben::parameter::PULSE_FREQUENCY;
use mckibben::simulation::Actuation;
use mckibben::valve::{Command, Request, ValveKind};

pub(super) fn warnings(of: &Parts<'_>) -> Vec<Warning> {
    let valves = of.plant.network().valves.iter().zip(&of.valves);
    valves.filter_map(|(valve, name)| of_valve(valve, name)).collect()
}

fn of_valve(of: &Actuation, name: &str) -> Option<Warning> {
    let command = of.command.map_requests(|request| of.solenoid.answer(request));
    for (request, where_to) in [(Request::Fill, "supply"), (Request::Exhaust, "exhaust")] {
        let Some(longest) = Longest::of(&command, request) else { continue };
        let [opens, closes] = delays(of, request);
        let Longest { pulse, pause, rounding, words, remedies } = longest;
        let found = [
            ("valve-never-opens", "opens", pulse, opens, words[0], remedies[0]),
            ("valve-never-closes", "closes", pause, closes, words[1], remedies[1]),
        ];
        for (code, verb, lasting, (key, delay), word, remedy) in found {
            if let Some(lasting) = lasting.filter(|lasting| *lasting + rounding < delay) {
                let [lasting, delay] = compared([lasting, delay], "s");
                let text = format!(
                    "the valve never {verb} to the {where_to}: {word} of {lasting} is shorter than {key} = {delay}; {remedy}"
                );
                return Some(Warning::new(code, name, text));
            }
        }
    }
    None
}

/// That a controller by pulses opens the path to the supply by a full output alone: even the longest of its pulses, a whole period, is
/// shorter than the delay.
pub(super) fn of_controller(of: &Actuation, name: &str, pulses: &Sampling) -> Option<Warning> {
    let [(key, delay), _] = delays(of, Request::Fill);
    let period = 1.0 / pulses.pulse_frequency();
    let is_short = period * (1.0 + SIMULTANEOUS) < delay;
    is_short.then(|| {
        // Where the file gives none, there is a pulse for each sample.
        let is_rate = pulses.pulse_frequency() == pulses.rate();
        let remedy = match is_rate {
            true => format!("give a {} below {}", PULSE_FREQUENCY.key, given(1.0 / delay, "Hz")),
            false => format!("lower {} = {}", PULSE_FREQUENCY.key, given(pulses.pulse_frequency(), "Hz")),
        };
        let [period, delay] = compared([period, delay], "s");
        let text = format!(
            "the pulses of the controller never open the valve to the supply, only its full output does: a whole period of {period} \
             is shorter than {key} = {delay}; {remedy}"
        );
        Warning::new("valve-never-opens", name, text)
    })
}

/// The longest pulse of a request in s, and the longest pause behind one; none where there is no such.
struct Longest {
    pulse: Option<f64>,
    pause: Option<f64>,
    /// By how much in s they may be too short by rounding.
    rounding: f64,
    /// What they are called in the command, and what makes each of them longer.
    words: [&'static str; 2],
    remedies: [&'static str; 2],
}

impl Longest {
    /// None where the command makes no pulses of the request.
    fn of(command: &Command, request: Request) -> Option<Self> {
        match command {
            Command::Pwm { frequency, duty, pulse, rest } => {
                // What is commanded all the time is meant.
                if !(*duty > 0.0 && *duty < 1.0) {
                    return None;
                }
                let lasting = [duty / frequency, (1.0 - duty) / frequency];
                let rounding = SIMULTANEOUS / frequency;
                let (words, remedies) = (["a pulse", "a pause"], [RAISE, LOWER]);
                match (*pulse == request, *rest == request) {
                    (true, false) => {
                        Some(Self { pulse: Some(lasting[0]), pause: Some(lasting[1]), rounding, words, remedies })
                    }
                    (false, true) => {
                        let (words, remedies) = (["a pause", "a pulse"], [LOWER, RAISE]);
                        Some(Self { pulse: Some(lasting[1]), pause: Some(lasting[0]), rounding, words, remedies })
                    }
                    _ => None,
                }
            }
            Command::Table { time, request: requests } => {
                let (words, remedies) = (["the longest pulse", "the longest pause"], [LATER; 2]);
                let rounding = SIMULTANEOUS * time.last().copied().unwrap_or(0.0).abs();
                let mut longest = Self { pulse: None, pause: None, rounding, words, remedies };
                // Whether it is requested, and since when.
                let mut begun: Option<(bool, f64)> = None;
                let ends = time.iter().copied().skip(1).chain([f64::INFINITY]);
                for ((start, end), is_on) in time.iter().zip(ends).zip(requests.iter().map(|of| *of == request)) {
                    let since = match begun {
                        Some((was_on, since)) if was_on == is_on => since,
                        // Before its first pulse a path is shut anyway.
                        None if !is_on => continue,
                        _ => *start,
                    };
                    begun = Some((is_on, since));
                    let lasting = if is_on { &mut longest.pulse } else { &mut longest.pause };
                    *lasting = Some(lasting.unwrap_or(0.0).max(end - since));
                }
                Some(longest)
            }
            _ => None,
        }
    }
}

const RAISE: &str = "raise command.duty or lower command.frequency";
const LOWER: &str = "lower command.duty or lower command.frequency";
const LATER: &str = "let it last longer in command.time";

/// The delays after which the path of a request opens and closes, with their keys.
fn delays(of: &Actuation, request: Request) -> [(&'static str, f64); 2] {
    let [opening, closing] = of.solenoid.delays();
    let (energised, released) = (("valve.opening_delay", opening), ("valve.closing_delay", closing));
    let by_coil = match of.solenoid.kind() {
        ValveKind::TwoWay | ValveKind::ThreeWay => request == Request::Fill,
        ValveKind::ThreeWayNormallyOpen => request == Request::Exhaust,
        ValveKind::FillHoldExhaust => true,
    };
    if by_coil { [energised, released] } else { [released, energised] }
}
