//! Advice of the programs of a case about effects in its scene. Programs that do not take part in
//! the run are asked too.

use crate::error::RunError;
use crate::fleet::Fleet;
use crate::plan::Planned;
use crate::program::Program;
use case::schema::WELL_KNOWN_ROLES;
use contract::advice::{Advice, Known, Opinion, Scene};

/// Number of rounds. In the second one, the first program hears the estimates of the others.
const TURNS: usize = 2;

/// Asks every program that advises. The first program in the flow of data that advises on an effect
/// decides.
///
/// # Errors
/// A program fails, or its answer is invalid.
pub fn ask(planned: &Planned, fleet: &mut Fleet) -> Result<Vec<Advice>, RunError> {
    let programs = advising(planned, fleet);
    let mut known = Known::new();
    let mut opinions: Vec<Opinion> = Vec::new();
    for _ in 0..TURNS {
        opinions.clear();
        for (role, program) in &programs {
            let case = planned.case.values.clone();
            let scene = Scene { case, mode: planned.plan.mode, known: known.clone() };
            let opinion = fleet.advise(role, program, &scene)?;
            known.extend(opinion.known.clone());
            opinions.push(opinion);
        }
    }
    let mut advice: Vec<Advice> = Vec::new();
    for one in opinions.into_iter().flat_map(|opinion| opinion.advice) {
        let offered = planned.plan.effects.iter().any(|effect| effect.name == one.effect);
        if offered && advice.iter().all(|known| known.effect != one.effect) {
            advice.push(one);
        }
    }
    Ok(advice)
}

/// Returns the programs that advise with their roles: participants in the order of the flow of
/// data, then idle and well-known roles. Planning has asked all of them for their descriptions.
fn advising(planned: &Planned, fleet: &Fleet) -> Vec<(String, Program)> {
    let running = planned.plan.participants.iter().map(|one| one.role.as_str());
    let idle = planned.case.idle.iter().map(String::as_str);
    let mut programs: Vec<(String, Program)> = Vec::new();
    for role in running.chain(idle).chain(WELL_KNOWN_ROLES.iter().copied()) {
        let program = fleet.program(role, planned.case.command(role).as_deref());
        let advises = fleet.description(&program).is_some_and(|of| of.advises);
        if advises && programs.iter().all(|(known, _)| known != role) {
            programs.push((role.to_owned(), program));
        }
    }
    programs
}
