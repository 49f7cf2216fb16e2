"""Registers in kernels: neighbouring entries of a row, taken together as one value.

LLVM makes vectors of a loop over columns, but not of a loop over bonds with columns inside it, so
that sums over bonds go through memory for every bond. Here some columns are one value, which stays
in registers while the bonds go by. In Python the same functions work with slices.

Every lane is computed alike, wherever its value begins and however many lanes are in use.
"""

from __future__ import annotations

import operator
from typing import Any

import llvmlite.binding as llvm
import numba as nb
from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import lower_builtin, models, register_model, type_callable

from ..arrays import Float

# As for `solver.operators.kernels`.
_FLAGS = ("contract", "nsz")
# Registers a value: two keep both multipliers busy, and leave room for three sums and their terms.
_REGISTERS = 2


def width(array: Float) -> int:
    """Lanes of a value from an array: as many as fill its registers."""
    return _count(array.dtype.itemsize)


def load(array: Float, row: int, at: int, used: int | None) -> Float:
    """Neighbouring entries of a row, from `at` on: all lanes, or the first `used`."""
    return array[row, int(at) : int(at) + int(width(array) if used is None else used)]


def store(array: Float, row: int, at: int, used: int | None, value: Float) -> None:
    """Write lanes to neighbouring entries of a row: all, or the first `used`."""
    array[row, int(at) : int(at) + int(width(array) if used is None else used)] = value


def bytes_of_a_register() -> int:
    """What a vector register holds of the processor that Numba compiles for."""
    features = getattr(nb.config, "CPU_FEATURES", None)
    if features is None:
        features = llvm.get_host_cpu_features().flatten()
    own = features.split(",")
    return 64 if "+avx512f" in own else 32 if "+avx" in own else 16


def _count(itemsize: int) -> int:
    return _REGISTERS * bytes_of_a_register() // itemsize


# ---- what Numba is told ---------------------------------------------------------------------


class _Lanes(types.Type):
    """Several floats."""

    def __init__(self, dtype: types.Float) -> None:
        self.dtype, self.count = dtype, _count(dtype.bitwidth // 8)
        super().__init__(name=f"Lanes({dtype}, {self.count})")


@register_model(_Lanes)
class _Model(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: _Lanes) -> None:
        entry = manager.lookup(kind.dtype).get_value_type()
        super().__init__(manager, kind, ir.VectorType(entry, kind.count))


def _rows(array: types.Type) -> bool:
    return isinstance(array, types.Array) and array.ndim == 2 and array.layout == "C"


@type_callable(width)
def _type_width(context: Any) -> Any:
    return lambda array: types.uint64 if _rows(array) else None


@type_callable(load)
def _type_load(context: Any) -> Any:
    return lambda array, row, at, used: _Lanes(array.dtype) if _rows(array) else None


@type_callable(store)
def _type_store(context: Any) -> Any:
    return lambda array, row, at, used, value: types.none if _rows(array) else None


@lower_builtin(width, types.Array)
def _width(context: Any, builder: Any, signature: Any, given: Any) -> Any:
    count = _Lanes(signature.args[0].dtype).count
    return context.get_constant(types.uint64, count)


def _place(context: Any, builder: Any, signature: Any, given: Any, lanes: _Lanes) -> Any:
    """Pointer to the first lane, and which are in use (None for all)."""
    kinds = signature.args
    array = context.make_array(kinds[0])(context, builder, given[0])
    row, at = (
        context.cast(builder, value, kind, types.intp)
        for value, kind in zip(given[1:3], kinds[1:3], strict=True)
    )
    _, columns = cgutils.unpack_tuple(builder, array.shape)
    first = builder.gep(array.data, [builder.add(builder.mul(row, columns), at)])
    kind = context.get_value_type(lanes)
    pointer = builder.bitcast(first, kind.as_pointer())
    if isinstance(kinds[3], types.NoneType):
        return pointer, None
    used = context.cast(builder, given[3], kinds[3], types.int32)
    places = ir.VectorType(ir.IntType(32), lanes.count)
    return pointer, builder.icmp_signed(
        "<", ir.Constant(places, list(range(lanes.count))), _spread(builder, used, lanes.count)
    )


def _spread(builder: Any, value: Any, count: int) -> Any:
    """The same value in all lanes."""
    kind = ir.VectorType(value.type, count)
    one = builder.insert_element(ir.Constant(kind, ir.Undefined), value, ir.IntType(32)(0))
    first = ir.Constant(ir.VectorType(ir.IntType(32), count), [0] * count)
    return builder.shuffle_vector(one, ir.Constant(kind, ir.Undefined), first)


def _masked(builder: Any, name: str, vector: Any, result: Any, *given: Any) -> Any:
    """Call LLVM's load or store of some lanes."""
    suffix = f"v{vector.count}{vector.element.intrinsic_name}"
    kind = ir.FunctionType(result, [value.type for value in given])
    # LLVM itself mends the name where pointers know no types.
    name = f"llvm.masked.{name}.{suffix}.p0{suffix}"
    return builder.call(cgutils.get_or_insert_function(builder.module, kind, name), given)


@lower_builtin(load, types.Array, types.Integer, types.Integer, types.Integer)
@lower_builtin(load, types.Array, types.Integer, types.Integer, types.NoneType)
def _load(context: Any, builder: Any, signature: Any, given: Any) -> Any:
    lanes = signature.return_type
    kind, size = context.get_value_type(lanes), lanes.dtype.bitwidth // 8
    pointer, used = _place(context, builder, signature, given, lanes)
    if used is None:
        return builder.load(pointer, align=size)
    zeros, size = ir.Constant(kind, None), ir.IntType(32)(size)
    return _masked(builder, "load", kind, kind, pointer, size, used, zeros)


@lower_builtin(store, types.Array, types.Integer, types.Integer, types.Integer, _Lanes)
@lower_builtin(store, types.Array, types.Integer, types.Integer, types.NoneType, _Lanes)
def _store(context: Any, builder: Any, signature: Any, given: Any) -> Any:
    lanes = signature.args[4]
    size = lanes.dtype.bitwidth // 8
    pointer, used = _place(context, builder, signature, given, lanes)
    if used is None:
        builder.store(given[4], pointer, align=size)
    else:
        vector, size = given[4], ir.IntType(32)(size)
        _masked(builder, "store", vector.type, ir.VoidType(), vector, pointer, size, used)
    return context.get_dummy_value()


@type_callable(operator.add)
@type_callable(operator.sub)
@type_callable(operator.mul)
def _type_arithmetic(context: Any) -> Any:
    def typed(one: types.Type, other: types.Type) -> types.Type | None:
        lanes = other if isinstance(other, _Lanes) else one
        if not isinstance(lanes, _Lanes):
            return None
        if all(kind in (lanes, lanes.dtype) for kind in (one, other)):
            return lanes
        return None

    return typed


@lower_builtin(operator.add, _Lanes, _Lanes)
@lower_builtin(operator.add, types.Float, _Lanes)
def _add(context: Any, builder: Any, signature: Any, given: Any) -> Any:
    return builder.fadd(*_alike(builder, signature, given), flags=_FLAGS)


@lower_builtin(operator.sub, _Lanes, _Lanes)
@lower_builtin(operator.sub, types.Float, _Lanes)
def _subtract(context: Any, builder: Any, signature: Any, given: Any) -> Any:
    return builder.fsub(*_alike(builder, signature, given), flags=_FLAGS)


@lower_builtin(operator.mul, _Lanes, _Lanes)
@lower_builtin(operator.mul, types.Float, _Lanes)
def _multiply(context: Any, builder: Any, signature: Any, given: Any) -> Any:
    return builder.fmul(*_alike(builder, signature, given), flags=_FLAGS)


def _alike(builder: Any, signature: Any, given: Any) -> list[Any]:
    """Both as lanes; a number is in all of them."""
    return [
        value if isinstance(kind, _Lanes) else _spread(builder, value, signature.return_type.count)
        for value, kind in zip(given, signature.args, strict=True)
    ]
