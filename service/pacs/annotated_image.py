"""A picture with what was found in an image, as DICOM Secondary Capture (PS3.3 A.8.1)."""

import cv2
import numpy as np
from pydicom import Dataset
from pydicom.uid import SecondaryCaptureImageStorage

from service.images.store import StoredImage
from service.pacs.derived import DerivedObject, ObjectKind, Place, derived_dataset, finished


def annotated_image(
    identity: Dataset, place: Place, picture_png: bytes, source: StoredImage, words: str
) -> DerivedObject:
    """The picture, RGB; `source` is the image that it was drawn on, `words` say what it shows."""
    picture = cv2.cvtColor(cv2.imdecode(np.frombuffer(picture_png, np.uint8), cv2.IMREAD_COLOR), cv2.COLOR_BGR2RGB)
    dataset = derived_dataset(identity, place, SecondaryCaptureImageStorage, "XA")
    dataset.SeriesDescription, dataset.ImageComments = "Coaxial: what was found", words
    dataset.ConversionType = "WSD"
    dataset.ImageType = ["DERIVED", "SECONDARY"]
    dataset.PatientOrientation = dataset.Laterality = ""  # oblique, of the spine: no letter would be true
    dataset.DerivationDescription = f"distortion corrected, enlarged, annotated; original {source.sop_uid}"
    dataset.SamplesPerPixel, dataset.PhotometricInterpretation, dataset.PlanarConfiguration = 3, "RGB", 0
    dataset.Rows, dataset.Columns = picture.shape[:2]
    dataset.BitsAllocated, dataset.BitsStored, dataset.HighBit, dataset.PixelRepresentation = 8, 8, 7, 0
    dataset.PixelData = picture.tobytes() + b"\0" * (picture.size % 2)
    dataset["PixelData"].VR = "OW"
    return finished(ObjectKind.ANNOTATED_IMAGE, dataset)
