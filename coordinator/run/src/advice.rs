//! Advice of the programs of a case about effects in its scene. Programs that do not take part in
//! the run are asked too.

use crate::error::RunError;
use crate::plan::Planned;
use crate::programs::{self, Program};
use case::schema::WELL_KNOWN_ROLES;
use contract::advice::{Advice, Known, Opinion, Scene};
use std::time::Duration;

/// Longest time that a program may take to advise.
const ANSWER: Duration = Duration::from_secs(30);
/// Number of rounds. In the second one, the first program hears the estimates of the others.
const TURNS: usize = 2;

/// Asks every program that advises. The first program in the flow of data that advises on an effect
/// decides. Starts no run.
///
/// # Errors
/// A program fails, or its answer is invalid.
pub fn ask(planned: &Planned) -> Result<Vec<Advice>, RunError> {
    programs::wait_for(ask_async(planned))
}

async fn ask_async(planned: &Planned) -> Result<Vec<Advice>, RunError> {
    let programs = advising(planned).await;
    let mut known = Known::new();
    let mut opinions: Vec<Opinion> = Vec::new();
    for _ in 0..TURNS {
        opinions.clear();
        for (role, program) in &programs {
            let case = planned.case.values.clone();
            let scene = Scene { case, mode: planned.plan.mode, known: known.clone() };
            let opinion = program.advise(role, &scene, ANSWER).await?;
            opinion.check().map_err(|fault| program.misled(role, fault))?;
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
/// data, then idle and well-known roles.
async fn advising(planned: &Planned) -> Vec<(String, Program)> {
    let mut programs: Vec<(String, Program)> = Vec::new();
    for one in &planned.plan.participants {
        if one.description.advises {
            programs.push((one.role.clone(), one.program.clone()));
        }
    }
    let idle = planned.case.idle.iter().map(String::as_str);
    for role in idle.chain(WELL_KNOWN_ROLES.iter().copied()) {
        let takes_part = planned.plan.participants.iter().any(|one| one.role == role);
        if takes_part || programs.iter().any(|(known, _)| known == role) {
            continue;
        }
        let program = Program::of_role(role, planned.case.command(role).as_deref());
        if program.describe(role, ANSWER).await.is_ok_and(|description| description.advises) {
            programs.push((role.to_owned(), program));
        }
    }
    programs
}
