"""Where trees can be."""

from __future__ import annotations

from dataclasses import dataclass

from . import _kdray
from ._arrays import whole


@dataclass(frozen=True)
class Device:
    """A device that trees can be built and asked on.

    >>> import kdray
    >>> kdray.devices()[0]
    Device(name='cpu', kind='cpu', index=None, backend='', driver='')
    """

    name: str
    """`cpu`, or what its driver calls it."""
    kind: str
    """`cpu`; of GPUs `discrete`, `integrated`, `virtual`, `other` or `software`, a program."""
    index: int | None = None
    """Its place among the GPUs."""
    backend: str = ""
    """Through what it is talked to: Vulkan, Metal or Direct3D 12."""
    driver: str = ""
    """Name and version of its driver."""


def devices() -> list[Device]:
    """The devices of this machine, for `kdray.build(..., device=...)` and `Tree.to`.

    The first is the CPU, the others are GPUs of Vulkan, Metal or Direct3D 12.

    >>> import kdray
    >>> kdray.devices()[0].name
    'cpu'
    """
    gpus = (
        Device(name, kind, index, backend, driver)
        for index, name, kind, backend, driver in _kdray.gpus()
    )
    return [Device("cpu", "cpu"), *gpus]


def device_word(device: Device | str | int) -> str:
    """A device as the extension module takes it."""
    if isinstance(device, Device):
        return device.name if device.index is None else str(device.index)
    if isinstance(device, str):
        return device
    return str(whole("device", device, 0))
