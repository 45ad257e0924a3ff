"""The software bill of materials, in CycloneDX 1.6."""

from __future__ import annotations

import uuid
from datetime import UTC, datetime

from cyclonedx.factory.license import LicenseFactory
from cyclonedx.model import HashType
from cyclonedx.model.bom import Bom
from cyclonedx.model.component import Component, ComponentType
from cyclonedx.output.json import JsonV1Dot6
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator
from packageurl import PackageURL

import place
from packages import Package


def written(packages: list[Package]) -> bytes:
    """Return the bill as JSON, checked with CycloneDX's schema."""
    bill = Bom()
    bill.metadata.timestamp = datetime.fromtimestamp(place.epoch(), UTC)
    root = Component(name="taotie", version=place.version(), type=ComponentType.APPLICATION, bom_ref=f"taotie@{place.version()}",
                     licenses=[LicenseFactory().make_from_string("MIT OR Apache-2.0")])
    bill.metadata.component = root
    components = {package.url: component(package) for package in packages}
    bill.components.update(components.values())
    bill.register_dependency(root, components.values())
    for package in packages:
        bill.register_dependency(components[package.url], [components[url] for url in package.needs])
    # The same for the same content.
    bill.serial_number = uuid.uuid5(uuid.NAMESPACE_URL, " ".join(sorted(components)) + str(place.epoch()))
    text = JsonV1Dot6(bill).output_as_string(indent=1)
    fault = JsonStrictValidator(SchemaVersion.V1_6).validate_str(text)
    if fault is not None:
        raise SystemExit(f"make dist: the bill of materials is not valid CycloneDX: {fault}")
    return text.encode() + b"\n"


def component(package: Package) -> Component:
    licences = [LicenseFactory().make_from_string(package.licence)] if package.licence else []
    hashes = [HashType.from_composite_str(f"sha256:{package.checksum}")] if package.checksum else []
    return Component(
        name=package.name, version=package.version, type=ComponentType.LIBRARY, bom_ref=package.url,
        purl=PackageURL.from_string(package.url), licenses=licences, hashes=hashes,
    )
