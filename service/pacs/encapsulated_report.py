"""The report of a case as DICOM Encapsulated PDF (PS3.3 A.45.1)."""

from pydicom import Dataset
from pydicom.sr.codedict import codes
from pydicom.uid import EncapsulatedPDFStorage

from service.pacs.derived import DerivedObject, ObjectKind, Place, derived_dataset, finished


def encapsulated_report(identity: Dataset, place: Place, pdf: bytes) -> DerivedObject:
    """The PDF to the byte; an odd one is padded, and its length says so."""
    dataset = derived_dataset(identity, place, EncapsulatedPDFStorage, "DOC")
    dataset.SeriesDescription = dataset.DocumentTitle = "Coaxial: case report"
    dataset.ConversionType = "WSD"
    dataset.AcquisitionDateTime = ""
    dataset.BurnedInAnnotation = "YES"  # the pages name the patient
    dataset.ConceptNameCodeSequence = [_title()]
    dataset.MIMETypeOfEncapsulatedDocument = "application/pdf"
    dataset.EncapsulatedDocument = pdf + b"\0" * (len(pdf) % 2)
    dataset.EncapsulatedDocumentLength = len(pdf)
    return finished(ObjectKind.REPORT, dataset)


def _title() -> Dataset:
    code = codes.LN.DiagnosticInterventionalRadiologyReport
    title = Dataset()
    title.CodeValue, title.CodingSchemeDesignator, title.CodeMeaning = code.value, code.scheme_designator, code.meaning
    return title
