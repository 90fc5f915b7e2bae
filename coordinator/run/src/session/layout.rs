//! What is demanded of the answer to a configuration.

use contract::configuration::{Configuration, Layout};

/// What is wrong with a layout as the answer to a configuration, if anything.
#[must_use]
pub fn layout_fault(configuration: &Configuration, layout: &Layout) -> Option<String> {
    if let Err(fault) = layout.check() {
        return Some(fault);
    }
    let mut sent = configuration.outputs.iter().chain(&configuration.observed);
    if let Some(field) = sent.find(|field| layout.grid_of(field).is_none()) {
        return Some(format!("its layout has no grid for `{field}`"));
    }
    let received = |field: &str| configuration.inputs.iter().any(|i| i.field.name == field);
    let wish = layout.inputs.iter().find(|wish| !received(&wish.field))?;
    Some(format!("it requests a grid for `{}`, which is not an input of it", wish.field))
}
