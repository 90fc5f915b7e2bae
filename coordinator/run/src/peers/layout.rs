//! Checks of the layout that answers a configuration.

use contract::configuration::{Configuration, Layout};
use contract::grid::Grid;

/// Returns the fault in a layout as the answer to a configuration, if any.
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
    Some(format!("it requests a grid for `{}`, which is not one of its inputs", wish.field))
}

/// Returns the fault of a field on a volume or at points that others consume, if any. Planning
/// refuses such a case before, unless the participant is configured only in a run.
#[must_use]
pub fn volume_fault(configuration: &Configuration, layout: &Layout) -> Option<String> {
    let unfit = |field: &&String| layout.grid_of(field).is_some_and(Grid::only_written);
    let field = configuration.outputs.iter().find(unfit)?;
    Some(format!(
        "`{field}`, which another participant consumes, is on a volume or at points: such fields are \
         only written out"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use contract::configuration::{FieldOnGrid, Mode};
    use contract::grid::{Block, Hexahedra, Places, Points, Shape};

    #[test]
    fn what_others_consume_is_on_no_volume() {
        let mut configuration = Configuration {
            role: "one".to_owned(),
            model: "law".to_owned(),
            mode: Mode::Steady,
            windows: None,
            case: Default::default(),
            histories: None,
            threads: 1,
            inputs: Vec::new(),
            outputs: Vec::new(),
            observed: vec!["inside".to_owned()],
        };
        let hexahedra = Hexahedra::Structured { ni: 2, nj: 1, nk: 1 };
        let layout = Layout {
            grids: vec![Grid::volume("body", hexahedra)],
            fields: vec![FieldOnGrid { field: "inside".to_owned(), grid: "body".to_owned() }],
            ..Layout::default()
        };
        assert_eq!(volume_fault(&configuration, &layout), None);
        std::mem::swap(&mut configuration.outputs, &mut configuration.observed);
        let fault = volume_fault(&configuration, &layout).unwrap();
        assert!(fault.contains("`inside`, which another participant consumes, is on a volume"));
        let block = Block { name: "line".to_owned(), places: Places::List(vec![[0.0; 3]]) };
        let shape = Shape::Points(Points { blocks: vec![block] });
        let grids = vec![Grid { name: "body".to_owned(), revision: 1, shape }];
        let fault = volume_fault(&configuration, &Layout { grids, ..layout }).unwrap();
        assert!(fault.contains("only written out"));
    }
}
