//! Python values as keys of scene files, and NumPy arrays as lists of bodies.

use crate::error::at;
use localshape::scene::{BodyLists, Coordinates};
use localshape::toml::{Table, Value};
use numpy::{Element, PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};

/// How deep tables and lists may be nested: a list that contains itself ends here.
const DEEPEST: usize = 64;

/// The keys of a scene, and the arrays among the lists of its bodies.
pub(crate) fn keys(keys: &Bound<'_, PyDict>) -> PyResult<(Table, Vec<BodyLists>)> {
    let mut lists = Vec::new();
    // Bodies are tables of a copy, from which arrays are taken.
    let table = match keys.get_item("body")? {
        Some(body) => {
            let keys = keys.copy()?;
            keys.set_item("body", without_arrays(&body, &mut lists)?)?;
            table(&keys, "", 0)?
        }
        None => table(keys, "", 0)?,
    };
    Ok((table, lists))
}

/// A body, or a list of several, without arrays, which become lists.
fn without_arrays<'py>(body: &Bound<'py, PyAny>, lists: &mut Vec<BodyLists>) -> PyResult<Bound<'py, PyAny>> {
    if let Ok(one) = body.cast::<PyDict>() {
        let (rest, found) = taken(one, "body")?;
        lists.push(found);
        return Ok(rest.into_any());
    }
    if !body.is_instance_of::<PyList>() && !body.is_instance_of::<PyTuple>() {
        return Ok(body.clone());
    }
    let rest = PyList::empty(body.py());
    for (at, one) in body.try_iter()?.enumerate() {
        let one = one?;
        match one.cast::<PyDict>() {
            Ok(one) => {
                let (other, found) = taken(one, &format!("body[{at}]"))?;
                rest.append(other)?;
                lists.push(found);
            }
            Err(_) => {
                rest.append(&one)?;
                lists.push(BodyLists::default());
            }
        }
    }
    Ok(rest.into_any())
}

/// The keys of a body that are no arrays, and the arrays.
fn taken<'py>(body: &Bound<'py, PyDict>, place: &str) -> PyResult<(Bound<'py, PyDict>, BodyLists)> {
    let (rest, mut lists) = (PyDict::new(body.py()), BodyLists::default());
    for (key, value) in body {
        let name: String = key.extract().unwrap_or_default();
        let place = format!("{place}.{name}");
        match value.cast::<PyUntypedArray>() {
            Ok(array) => match &*name {
                "nodes" => lists.nodes = Some(points(array, &place)?),
                "positions" => lists.positions = Some(points(array, &place)?),
                "velocities" => lists.velocities = Some(points(array, &place)?),
                "elements" => lists.elements = Some(rows(array, &place, 2)?),
                "faces" => lists.faces = Some(rows(array, &place, 3)?),
                "springs" => lists.springs = Some(pairs(array, &place)?),
                "masses" => {
                    lists.masses = Some(numbers(array, &place, "one number for each node", |shape| shape.len() == 1)?)
                }
                _ => rest.set_item(key, value)?,
            },
            Err(_) => rest.set_item(key, value)?,
        }
    }
    Ok((rest, lists))
}

/// The numbers of an array, row after row, if it has the right shape.
pub(crate) fn numbers(
    array: &Bound<'_, PyUntypedArray>,
    place: &str,
    expected: &str,
    fits: impl Fn(&[usize]) -> bool,
) -> PyResult<Vec<f64>> {
    values(array, place, (expected, "numbers", "fiu", "float64"), fits)
}

/// The values of an array of one of some `kinds`, copied as `typed`.
fn values<T: Element + Copy>(
    array: &Bound<'_, PyUntypedArray>,
    place: &str,
    (expected, what, kinds, typed): (&str, &str, &str, &str),
    fits: impl Fn(&[usize]) -> bool,
) -> PyResult<Vec<T>> {
    let (py, shape) = (array.py(), array.shape());
    if !fits(shape) {
        let found = PyTuple::new(py, shape)?.repr()?;
        return Err(at(py, place, format!("`{place}` has the shape {found}; expected {expected}"), None));
    }
    let kind: char = array.dtype().getattr("kind")?.extract()?;
    if !kinds.contains(kind) {
        return Err(at(py, place, format!("`{place}` is an array of {}; expected {what}", array.dtype()), None));
    }
    // A copy of its own, which nobody can change.
    let copy = py.import("numpy")?.call_method1("array", (array, typed))?;
    let copy = copy.call_method1("ravel", ("C",))?.cast_into::<PyArrayDyn<T>>()?;
    Ok(copy.to_vec()?)
}

/// Points in the plane or in space.
fn points(array: &Bound<'_, PyUntypedArray>, place: &str) -> PyResult<Vec<Coordinates>> {
    let expected = "one row for each node with 2 or 3 coordinates";
    let all = numbers(array, place, expected, |shape| shape.len() == 2 && [2, 3].contains(&shape[1]))?;
    Ok(match array.shape()[1] {
        2 => all.as_chunks::<2>().0.iter().map(|&point| point.into()).collect(),
        _ => all.as_chunks::<3>().0.iter().map(|&point| point.into()).collect(),
    })
}

/// Rows of nodes, with −1 at the end of shorter ones.
fn rows(array: &Bound<'_, PyUntypedArray>, place: &str, least: usize) -> PyResult<Vec<Vec<u32>>> {
    let expected = format!("rows of at least {least} nodes, with -1 at the end of shorter ones");
    let fits = |shape: &[usize]| shape.len() == 2 && shape[1] >= least;
    let all = values::<i64>(array, place, (&expected, "integers", "iu", "int64"), fits)?;
    let rows = all.chunks_exact(array.shape()[1]).enumerate().map(|(row, nodes)| {
        let used = nodes.iter().rposition(|&node| node != -1).map_or(0, |last| last + 1);
        let wrong = nodes[..used].iter().position(|&node| u32::try_from(node).is_err());
        if let Some(column) = wrong {
            let place = format!("{place}[{row}][{column}]");
            let message = match nodes[column] {
                -1 => format!("`{place}` is -1, but a node follows; expected -1 only at the end"),
                node => format!("`{place}` is {node}; expected the number of a node"),
            };
            return Err(at(array.py(), &place, message, None));
        }
        Ok(nodes[..used].iter().map(|&node| node as u32).collect())
    });
    rows.collect()
}

/// Pairs of nodes.
fn pairs(array: &Bound<'_, PyUntypedArray>, place: &str) -> PyResult<Vec<[u32; 2]>> {
    if array.shape().get(1) != Some(&2) {
        values::<i64>(array, place, ("one row for each spring with 2 nodes", "integers", "iu", "int64"), |_| false)?;
    }
    let rows = rows(array, place, 2)?.into_iter().enumerate();
    let pair = |(row, nodes): (usize, Vec<u32>)| {
        <[u32; 2]>::try_from(nodes).map_err(|nodes| {
            let place = format!("{place}[{row}]");
            let message = format!("`{place}` has {} nodes; expected 2", nodes.len());
            at(array.py(), &place, message, None)
        })
    };
    rows.map(pair).collect()
}

/// A dict as a table. Keys whose value is `None` are left out.
fn table(dict: &Bound<'_, PyDict>, place: &str, depth: usize) -> PyResult<Table> {
    let mut table = Table::new();
    for (key, inner) in dict {
        let Ok(name) = key.extract::<String>() else {
            let message = format!("`{place}` has the key {}; expected texts as keys", key.repr()?);
            return Err(at(dict.py(), place, message, None));
        };
        let place = if place.is_empty() { name.clone() } else { format!("{place}.{name}") };
        if !inner.is_none() {
            table.insert(name, value(&inner, &place, depth + 1)?);
        }
    }
    Ok(table)
}

/// A value at a place of the keys.
pub(crate) fn value(object: &Bound<'_, PyAny>, place: &str, depth: usize) -> PyResult<Value> {
    let (py, wrong) = (object.py(), |message| Err(at(object.py(), place, message, None)));
    if depth > DEEPEST {
        return wrong(format!("`{place}` is nested more than {DEEPEST} times"));
    }
    if object.is_instance_of::<PyBool>() {
        return Ok(Value::Boolean(object.extract()?));
    }
    if object.is_instance_of::<PyInt>() {
        let whole = || format!("`{place}` is {object}; expected a whole number of 64 bits");
        return object.extract().map_or_else(|_| wrong(whole()), |number| Ok(Value::Integer(number)));
    }
    if object.is_instance_of::<PyFloat>() {
        return Ok(Value::Float(object.extract()?));
    }
    if object.is_instance_of::<PyString>() {
        let text = object.extract().map(Value::String);
        // A lone surrogate is no text in UTF-8.
        return text.or_else(|_| wrong(format!("`{place}` has characters that are no text in UTF-8; expected text")));
    }
    if let Ok(dict) = object.cast::<PyDict>() {
        return Ok(Value::Table(table(dict, place, depth)?));
    }
    if object.is_instance_of::<PyList>() || object.is_instance_of::<PyTuple>() {
        let entries = object.try_iter()?.enumerate();
        let entries = entries.map(|(at, entry)| value(&entry?, &format!("{place}[{at}]"), depth + 1));
        return Ok(Value::Array(entries.collect::<PyResult<_>>()?));
    }
    // Arrays and numbers of NumPy, then paths.
    for (kind, method) in [("ndarray", "tolist"), ("generic", "item")] {
        if object.is_instance(&py.import("numpy")?.getattr(kind)?)? {
            let plain = object.call_method0(method)?;
            // Numbers that Python does not have stay what they are.
            if !plain.get_type().is(object.get_type()) {
                return value(&plain, place, depth + 1);
            }
        }
    }
    if object.hasattr("__fspath__")? {
        return value(&object.call_method0("__fspath__")?, place, depth + 1);
    }
    wrong(format!(
        "`{place}` is {}; expected a number, text, truth value, list, dict or array",
        object.get_type().name()?
    ))
}
