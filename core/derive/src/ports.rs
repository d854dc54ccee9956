//! `#[derive(Inputs)]` and `#[derive(Outputs)]`.

use crate::{Tokens, named_fields, required_docs};
use quote::quote;
use syn::ext::IdentExt;
use syn::{DeriveInput, Field, GenericArgument, PathArguments, Type};

pub(crate) fn expand_inputs(input: &DeriveInput) -> syn::Result<Tokens> {
    let name = &input.ident;
    let mut specs = Vec::new();
    let mut reads = Vec::new();
    for field in named_fields(input)? {
        let (target, optional) = referenced(&field.ty)?;
        specs.push(spec(field, target, optional)?);
        let (ident, key) = (&field.ident, key(field));
        let get = if optional { quote!(optional) } else { quote!(required) };
        reads.push(quote!(#ident: values.#get(#key)));
    }
    let (with, generics, bounds) = input.generics.split_for_impl();
    let lifetime = &input
        .generics
        .lifetimes()
        .next()
        .ok_or_else(|| syn::Error::new_spanned(input, "inputs are borrowed: add a lifetime"))?
        .lifetime;
    Ok(quote! {
        impl #with ::carvegraph_core::Inputs<#lifetime> for #name #generics #bounds {
            fn ports() -> ::std::vec::Vec<::carvegraph_core::PortSpec> {
                ::std::vec![#(#specs),*]
            }
            fn take(values: &#lifetime ::carvegraph_core::InputValues) -> Self {
                Self { #(#reads),* }
            }
        }
    })
}

pub(crate) fn expand_outputs(input: &DeriveInput) -> syn::Result<Tokens> {
    let name = &input.ident;
    let fields = named_fields(input)?;
    let specs = fields
        .iter()
        .map(|field| spec(field, &field.ty, false))
        .collect::<syn::Result<Vec<_>>>()?;
    let idents = fields.iter().map(|field| &field.ident);
    Ok(quote! {
        impl ::carvegraph_core::Outputs for #name {
            fn ports() -> ::std::vec::Vec<::carvegraph_core::PortSpec> {
                ::std::vec![#(#specs),*]
            }
            fn into_values(self) -> ::std::vec::Vec<::carvegraph_core::Value> {
                ::std::vec![#(::std::sync::Arc::new(self.#idents) as ::carvegraph_core::Value),*]
            }
        }
    })
}

fn key(field: &Field) -> String {
    field.ident.as_ref().map(|name| name.unraw().to_string()).unwrap_or_default()
}

fn spec(field: &Field, ty: &Type, optional: bool) -> syn::Result<Tokens> {
    let (key, about) = (key(field), required_docs(&field.attrs, field)?);
    Ok(quote! {
        ::carvegraph_core::PortSpec::of::<#ty>(#key, #about, #optional)
    })
}

/// The `T` of `&'a T` or `Option<&'a T>`, and whether it is optional.
fn referenced(ty: &Type) -> syn::Result<(&Type, bool)> {
    match ty {
        Type::Reference(reference) => Ok((&reference.elem, false)),
        Type::Path(path) => {
            let last = path.path.segments.last();
            if let Some(segment) = last.filter(|segment| segment.ident == "Option")
                && let PathArguments::AngleBracketed(arguments) = &segment.arguments
                && let Some(GenericArgument::Type(Type::Reference(inner))) = arguments.args.first()
            {
                return Ok((&inner.elem, true));
            }
            Err(syn::Error::new_spanned(ty, "an input is &'a T or Option<&'a T>"))
        }
        _ => Err(syn::Error::new_spanned(ty, "an input is &'a T or Option<&'a T>")),
    }
}
