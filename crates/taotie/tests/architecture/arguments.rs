//! Counts the arguments of functions as a caller sees them: tuples are expanded, and so are arrays of references that
//! the function destructures by name.

use syn::visit::Visit;
use syn::{FnArg, Pat, Signature, Type};

/// A function and its number of arguments, not counting the receiver.
#[derive(Debug, PartialEq, Eq)]
pub struct Function {
    pub name: String,
    pub arguments: usize,
}

/// Returns all functions in a source text.
pub fn functions(text: &str) -> syn::Result<Vec<Function>> {
    let file = syn::parse_file(text)?;
    let mut found = Found(Vec::new());
    found.visit_file(&file);
    Ok(found.0)
}

struct Found(Vec<Function>);

impl Visit<'_> for Found {
    fn visit_signature(&mut self, signature: &Signature) {
        let arguments = signature.inputs.iter().map(opened).sum();
        self.0.push(Function { name: signature.ident.to_string(), arguments });
    }
}

/// Counts the values that an argument carries.
fn opened(argument: &FnArg) -> usize {
    match argument {
        FnArg::Receiver(_) => 0,
        FnArg::Typed(typed) => parts(&typed.pat, &typed.ty),
    }
}

fn parts(pattern: &Pat, ty: &Type) -> usize {
    match (pattern, ty) {
        (_, Type::Tuple(tuple)) if tuple.elems.is_empty() => 1,
        (_, Type::Tuple(tuple)) => {
            tuple.elems.iter().map(|ty| parts(&Pat::Verbatim(Default::default()), ty)).sum()
        }
        (_, Type::Paren(inner)) => parts(pattern, &inner.elem),
        (Pat::Slice(names), Type::Array(array)) if matches!(*array.elem, Type::Reference(_)) => {
            names.elems.len()
        }
        _ => 1,
    }
}
