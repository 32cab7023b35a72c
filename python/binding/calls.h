// What a model answers, each kind of question in a file of its own.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <string>

#include "carnot/shooting/geodesic.h"
#include "model.h"
#include "text/json_text.h"

namespace carnot::python {

// Work in the background keeps the model that it is for.
using ModelPointer = std::shared_ptr<const Model>;
using ModelClass = pybind11::class_<Model, std::shared_ptr<Model>>;

void add_description(pybind11::module_& module, ModelClass& model);
void add_drawing(ModelClass& model);
void add_flows(ModelClass& model);
void add_searches(ModelClass& model);
void add_many(ModelClass& model);
void add_fields(ModelClass& model);
void add_steering(pybind11::module_& module);
void add_audits(ModelClass& model);

// JSON as a text that Python reads; numbers come back to the last bit.
pybind11::str text_of(const apps::Json& json);

// {"t", "q", "p", "lambda", "hamiltonian"} of a trajectory: arrays of n and k columns.
pybind11::dict trajectory_arrays(Trajectory trajectory, int n, int k);

}  // namespace carnot::python
