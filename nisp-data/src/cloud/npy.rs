//! NumPy arrays of n rows and at least three columns, alone or in an archive.

use std::io::{Cursor, Read};
use std::path::Path;

use npyz::npz::NpzArchive;
use npyz::{NpyFile, Order};

use crate::DataError;

pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Vec<[f64; 3]>, DataError> {
    let file = NpyFile::new(bytes).map_err(|error| unreadable(path, &error))?;
    rows(path, file)
}

/// Takes the only array that can be a cloud.
pub(super) fn parse_archive(path: &Path, bytes: &[u8]) -> Result<Vec<[f64; 3]>, DataError> {
    let mut archive = NpzArchive::new(Cursor::new(bytes)).map_err(|error| unreadable(path, &error))?;
    let names: Vec<String> = archive.array_names().map(str::to_string).collect();
    let mut fitting = Vec::new();
    for name in &names {
        let array = archive.by_name(name).map_err(|error| unreadable(path, &error))?;
        if array.is_some_and(|array| array.shape().len() == 2 && array.shape()[1] >= 3) {
            fitting.push(name);
        }
    }
    let [name] = fitting.as_slice() else {
        let what = format!(
            "{} of its arrays ({}) have the shape (n, 3); save the cloud alone as .npy",
            fitting.len(),
            names.join(", ")
        );
        return Err(DataError::file(path, what));
    };
    match archive.by_name(name).map_err(|error| unreadable(path, &error))? {
        Some(array) => rows(path, array),
        None => Err(DataError::file(path, format!("array `{name}` cannot be read"))),
    }
}

fn rows<R: Read>(path: &Path, file: NpyFile<R>) -> Result<Vec<[f64; 3]>, DataError> {
    let (shape, order) = (file.shape().to_vec(), file.order());
    let &[count, width] = shape.as_slice() else {
        return Err(DataError::file(path, format!("an array of shape {shape:?}; (n, 3) is needed")));
    };
    if width < 3 {
        return Err(DataError::file(path, format!("an array of shape {shape:?}; x, y and z are needed in each row")));
    }
    let flat = numbers(path, file)?;
    let (count, width) = (count as usize, width as usize);
    let at = |row: usize, column: usize| match order {
        Order::C => flat[row * width + column],
        Order::Fortran => flat[column * count + row],
    };
    Ok((0..count).map(|row| [at(row, 0), at(row, 1), at(row, 2)]).collect())
}

fn numbers<R: Read>(path: &Path, file: NpyFile<R>) -> Result<Vec<f64>, DataError> {
    let collect = |result: std::io::Result<Vec<f64>>| result.map_err(|error| unreadable(path, &error));
    let file = match file.try_data::<f64>() {
        Ok(data) => return collect(data.collect()),
        Err(file) => file,
    };
    match file.try_data::<f32>() {
        Ok(data) => collect(data.map(|value| value.map(f64::from)).collect()),
        Err(file) => {
            let what = format!("an array of type {}; save it as float32 or float64", file.dtype().descr());
            Err(DataError::file(path, what))
        }
    }
}

fn unreadable(path: &Path, error: &std::io::Error) -> DataError {
    let text = error.to_string().replace('\n', " ");
    DataError::file(path, format!("not a readable NumPy file ({text}); save it again"))
}
