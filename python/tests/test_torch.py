"""A run as a function of PyTorch. With its GPU libraries it is five gigabytes, more than all else that the tests install,
and PyPI has no smaller build: without it these tests are skipped, and the check's summary says so."""

from __future__ import annotations

import math

import numpy
import pytest

import mckibben

torch = pytest.importorskip("torch", reason="PyTorch is not installed: `pip install torch` (5 GB) adds these tests")

BY = ["load.mass", "command.duty", "actuator.turns", "supply.gauge_pressure"]


@pytest.fixture(scope="module")
def pulsed(examples) -> mckibben.Differentiable:
    scenario = mckibben.Scenario.from_file(examples / "paper/fig-12.toml")
    return mckibben.Differentiable(scenario, parameters=BY, quantities=["length", "gauge_pressure", "tension"], times=[0.053, 0.131])


@pytest.fixture
def start(pulsed):
    return torch.tensor(pulsed.defaults, requires_grad=True)


def test_values_and_derivatives_in_reverse_mode(pulsed, start):
    values, slopes = pulsed.value_and_jacobian(pulsed.defaults)
    function = pulsed.for_torch()
    found = function(start)
    numpy.testing.assert_array_equal(found.detach().numpy(), values)
    weights = torch.from_numpy(numpy.random.default_rng(3).uniform(-1, 1, values.shape))
    (weights * found).sum().backward()
    numpy.testing.assert_allclose(start.grad.numpy(), numpy.einsum("to,top->p", weights.numpy(), slopes), rtol=1e-12)
    jacobian = torch.autograd.functional.jacobian(function, start.detach())
    numpy.testing.assert_allclose(jacobian.numpy(), slopes, rtol=1e-14)


def test_derivatives_in_forward_mode(pulsed, start):
    _, slopes = pulsed.value_and_jacobian(pulsed.defaults)
    along = torch.from_numpy(pulsed.defaults * [0.1, -0.2, 0.3, 0.4])
    with torch.autograd.forward_ad.dual_level():
        dual = pulsed.for_torch()(torch.autograd.forward_ad.make_dual(start.detach(), along))
        tangent = torch.autograd.forward_ad.unpack_dual(dual).tangent
    numpy.testing.assert_allclose(tangent.numpy(), slopes @ along.numpy(), rtol=1e-14)


def test_the_transforms_of_torch_func(pulsed, start):
    """As in JAX: a Jacobian forwards and backwards, and many values one after another."""
    function, values = pulsed.for_torch(), start.detach()
    _, slopes = pulsed.value_and_jacobian(pulsed.defaults)
    for jacobian in [torch.func.jacfwd, torch.func.jacrev]:
        numpy.testing.assert_allclose(jacobian(function)(values).numpy(), slopes, rtol=1e-14)
    several = torch.stack([values, 1.01 * values])
    found = torch.func.vmap(function)(several)
    numpy.testing.assert_array_equal(found.numpy(), [pulsed(one.numpy()) for one in several])
    gradients = torch.func.vmap(torch.func.grad(lambda one: function(one)[:, 0].sum()))(several)
    expected = [pulsed.value_and_jacobian(one.numpy())[1][:, 0].sum(axis=0) for one in several]
    numpy.testing.assert_allclose(gradients.numpy(), expected, rtol=1e-13)


def test_a_batch_is_its_runs_one_by_one(pulsed):
    function = pulsed.for_torch()
    shares = torch.tensor([1.0, 1.02, 0.97], dtype=torch.float64)
    batch = shares[:, None] * torch.from_numpy(pulsed.defaults)
    alone = torch.stack([function(values) for values in batch])
    assert torch.equal(function(batch), alone)
    assert torch.equal(torch.func.vmap(function)(batch), alone)
    jacobians = torch.func.vmap(torch.func.jacrev(function))(batch)
    for values, jacobian in zip(batch, jacobians):
        expected = torch.from_numpy(pulsed.value_and_jacobian(values.numpy())[1])
        torch.testing.assert_close(jacobian, expected, rtol=1e-13, atol=0.0)
    tangent = torch.full_like(batch, 1e-3)
    _, along = torch.func.jvp(function, (batch,), (tangent,))
    torch.testing.assert_close(along, torch.einsum("btop,bp->bto", jacobians, tangent), rtol=1e-12, atol=1e-18)


@pytest.mark.parametrize("device", ["cpu", *(["cuda"] if torch.cuda.is_available() else [])])
def test_what_is_on_a_device_stays_there(pulsed, device):
    function, (found, slopes) = pulsed.for_torch(), pulsed.value_and_jacobian(pulsed.defaults)
    start = torch.tensor(pulsed.defaults, device=device, requires_grad=True)
    values = function(start)
    assert values.device == start.device
    numpy.testing.assert_array_equal(values.detach().cpu().numpy(), found)
    values[:, 0].sum().backward()
    assert start.grad.device == start.device
    numpy.testing.assert_allclose(start.grad.cpu().numpy(), slopes[:, 0].sum(axis=0), rtol=1e-13)
    batch = torch.stack([start.detach(), 1.01 * start.detach()])
    for jacobian in [torch.func.jacfwd, torch.func.jacrev]:
        several = torch.func.vmap(jacobian(function))(batch)
        assert several.device == start.device
        numpy.testing.assert_allclose(several[0].cpu().numpy(), slopes, rtol=1e-13)


def test_what_it_has_not_is_refused_and_not_zero(pulsed, start):
    function = pulsed.for_torch()
    (first,) = torch.autograd.grad((function(start) ** 2).sum(), start, create_graph=True)
    with pytest.raises(mckibben.InputError, match="second derivatives"):
        torch.autograd.grad(first.sum(), start)
    for outer in [torch.func.jacfwd, torch.func.jacrev]:
        for inner in [torch.func.jacfwd, torch.func.jacrev]:
            with pytest.raises((mckibben.InputError, RuntimeError), match="second derivatives"):
                outer(inner(lambda values: function(values)[:, 0].sum()))(start.detach())
    with pytest.raises(mckibben.InputError, match="float64"):
        function(start.float())
    with pytest.raises(mckibben.InputError, match="load.mass"):
        function(-start)


def test_a_fit_by_an_optimiser_of_torch_finds_what_made_the_data(pulsed):
    function = pulsed.for_torch()
    true = pulsed.defaults.copy()
    data = torch.from_numpy(pulsed(true))
    logarithm = torch.zeros(1, dtype=torch.float64, requires_grad=True)
    scale, rest = data.abs().max(dim=0).values, torch.from_numpy(true)

    def mismatch():
        optimiser.zero_grad()
        mass = 1.1 * torch.exp(logarithm) * rest[:1]
        loss = (((function(torch.cat([mass, rest[1:]])) - data) / scale) ** 2).sum()
        loss.backward()
        return loss

    optimiser = torch.optim.LBFGS([logarithm], lr=0.1, max_iter=30, tolerance_grad=1e-12, line_search_fn="strong_wolfe")
    optimiser.step(mismatch)
    assert 1.1 * math.exp(logarithm.item()) == pytest.approx(1.0, rel=1e-5)


def test_an_empty_batch_has_empty_values_and_derivatives(pulsed):
    function = pulsed.for_torch()
    empty = torch.zeros((0, len(BY)), dtype=torch.float64, requires_grad=True)
    values = function(empty)
    assert values.shape == (0, 2, 3)
    values.sum().backward()
    assert empty.grad.shape == empty.shape
    assert function(torch.zeros((3, 0, len(BY)), dtype=torch.float64)).shape == (3, 0, 2, 3)
    with pytest.raises(mckibben.InputError, match="4 arguments"):
        function(torch.zeros((0, 1), dtype=torch.float64))
