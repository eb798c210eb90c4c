"""Every warning and error of the core as a kind with numbers, and its sentence.

The sentences name no menu of any program. An outer layer recognises a message by its kind and adds its own advice.
"""

from __future__ import annotations

from typing import Any

_SENTENCES: dict[str, str | tuple[str, str]] = {  # a pair: for a count of 1, and for any other
    # the mesh as given
    "not_numbers": "Vertices and faces must be arrays of numbers ({reason}).",
    "no_faces": "The mesh has no faces. Choose a mesh with a surface.",
    "vertex_shape": "Vertices must be an (n, 3) array; got shape {shape}.",
    "face_shape": "Faces must be an (m, 3) array of triangles; got shape {shape}.",
    "face_type": "Faces must be integers; got {type}.",
    "not_finite": (
        "1 vertex has coordinates that are not numbers. Delete or repair it.",
        "{count:,} vertices have coordinates that are not numbers. Delete or repair them.",
    ),
    "face_range": "Faces refer to vertices outside 0 to {last}.",
    "no_area": "The surface has no area. Choose a mesh with a surface.",
    "rest_shape": "The rest pose must have one position for each of the {count} vertices.",
    "form_shape": "The form must be a ({count}, 3) array of numbers.",
    # its repair
    "repeated_corners": (
        "1 face was left out: it repeats a vertex.",
        "{count:,} faces were left out: they repeat a vertex.",
    ),
    "coincident_borders": "Borders coincide: {count:,} vertices were taken as joined.",
    "duplicate_faces": (
        "1 face was left out: it is a duplicate.",
        "{count:,} faces were left out: they are duplicates.",
    ),
    "inconsistent_faces": (
        "1 face was flipped to agree with its neighbours.",
        "{count:,} faces were flipped to agree with their neighbours.",
    ),
    "rounded_positions": "The mesh lies so far from its origin that it loses detail. Positions are rounded to "
    "{share:.1%} of its size. Move it to the origin before modelling or scanning detail.",
    # its pieces
    "too_many_pieces": "The mesh has {count:,} loose parts, more than {most:,}. Merge what belongs together, or "
    "delete or separate the small parts, and run again.",
    "pieces_without_area": "Loose parts without area ({count}) were not moved.",
    "several_pieces": "The mesh has {count} loose parts. Each has its own feature points and form and stays in place; "
    "join parts that should move together first.",
    "several_bodies": "The mesh has {count} bodies that do not touch, or only touch. Each has its own feature "
    "points and form and stays in place.",
    "small_pieces_ride": "Small loose parts ({count:,}) follow the nearest larger part.",
    "rider_stretched": "Some loose parts lie on others that move apart. They were moved rigidly.",
    # what makes a form doubtful
    "no_pairs": (
        "Only 1 limb was found. Fix the others by hand.",
        "{count} limbs were found, but no pairs. Fix the missing ones by hand.",
    ),
    "one_pair": "Only one pair of limbs was found. Fix the missing ones by hand.",
    "no_head": "No head was found, only limbs in pairs. If there is one, fix it by hand.",
    "unpaired_ends": (
        "1 limb has no partner on the other side. Fix the missing one by hand.",
        "{count} limbs have no partner on the other side. Fix the missing ones.",
    ),
    "twisted": "Left and right of the limbs disagree: fix them by hand.",
    "handles": (
        "Skin may have grown together: the surface has a handle.",
        "Skin may have grown together: the surface has {count} handles.",
    ),
    "contacts_opened": (
        "Skin has probably grown together in 1 place. It was parted there.",
        "Skin has probably grown together in {count} places. It was parted there.",
    ),
    "contacts_largest": "Only the largest body was searched for skin in contact.",
    "contacts_left": "Some limbs have probably grown together with the body.",
    "contacts_left_beside": "Some limbs have probably grown together. Or the reference is another body.",
    "contacts_unknown": "The reference is too unlike this body. Whether skin has grown together is not known.",
    "part_here_nothing": "Nothing was parted: mark whole edges or faces.",
    "part_here_all": "A piece is marked as a whole: nothing was parted there. Mark only where parts meet.",
    "part_here_loose": (
        "The marks cut 1 piece off. If it is not to come off, unmark some of its rim.",
        "The marks cut {count} pieces off. If they are not to come off, unmark some of their rims.",
    ),
    "hardly_unbent": "The form is nearly the mesh itself: nothing was unbent.",
    "loose_vertices": (
        "1 vertex that belongs to no face stays where it is.",
        "{count:,} vertices that belong to no face stay where they are.",
    ),
    "stray_vertices": (
        "1 vertex lies far away from all its neighbours. It was left out and follows them.",
        "{count:,} vertices lie far away from all their neighbours. They were left out and follow them.",
    ),
    "more_warnings": "There are {count} more warnings like these about other parts.",
    # files of results
    "file_kind": "Only results can be saved ({kinds}); got {type}.",
    "file_later": "This file was written by a later version. Update Canonical Form to load it.",
    "file_damaged": "{name} does not hold a result of Canonical Form, or is damaged.",
    # settings and choices
    "unknown_option": "There is no option {name!r}. Options: {names}.",
    "options_type": "Options must be Settings, or a dictionary by name; got {type}.",
    "setting_range": "{name} must be {range}; got {value!r}.",
    "unknown_method": "method must be one of {names}; got {value!r}.",
    "unknown_kind": "kind must be one of {names}; got {value!r}.",
    "feature_list": "feature_points must be a list of at least one vertex index.",
    "vertex_range": "{name} must lie between 0 and {last}.",
    "feature_twice": "feature_points contains a vertex twice.",
    "feature_names": "feature_names must give each of feature_points one of {names}, or an empty text.",
    "feature_name_twice": "feature_names contains a name twice.",
    "feature_off_surface": "feature_points has vertices of no face with area.",
    "feature_coincident": "feature_points has two vertices at one position.",
    "features_detected_elsewhere": "{count} loose parts have none of the given feature points. Theirs were detected.",
    "source_list": "Source vertices must be a list of at least one whole number.",
    "source_range": "Source vertices must lie between 0 and {last}.",
    "too_many_sources": "Select at most {most:,} source vertices. {count:,} are selected.",
    "limb_mask": "chosen must be a boolean array of length {count}.",
    "limb_ways": "ways must lie between 0 and 1.",
    "diffusion_time": "The diffusion time must be positive; got {value}.",
    # a reference
    "reference_without_limbs": "The reference has no feature points. Compute its form again and use that.",
    "reference_bodies": "This mesh has {count} bodies and the reference {others}. Only those that both have, the "
    "largest first, were aligned to it.",
    "reference_far": "The reference lies too far from the origin. Use one unit for both meshes, and move the reference "
    "near the origin.",
    "reference_unlike": "This body differs too much from the reference. Check the orientation of the form, or choose "
    "another reference.",
    "reference_sides": "The reference looks alike from two sides. Check how the form lies.",
    "upright_by_file": "The form stands as in the file. The surface does not tell head from feet, or front from back: "
    "check how it lies.",
    "upside_down": "The form stands the other way up than the file. If the file is right, choose a reference that "
    "stands as it should, or keep the form as posed.",
    "reference_features": "This body has {count} feature points, the reference {others}. If one has no counterpart, "
    "the numbers after it differ.",
    # a match
    "match_side": 'The side must be "auto" or a non-negative whole number; got {value!r}.',
    "match_no_side": "There are {count} ways to match these meshes; side must lie between 0 and {last}.",
    "match_pose": "The pose of the reference needs one position for each of its {count} vertices.",
    "stance_pose": "The pose must be 'T' or 'A'; got {value!r}.",
    "rig_pose": "The pose at rest must be 'T', 'A', 'rest' or None; got {value!r}.",
    "stance_arrays": "The rig needs a head, a tail and a parent for each of its {bones} bones, and one weight of each "
    "for each of the {vertices} vertices.",
    "stance_limbs": "These bones do not show two arms and two legs. Neither their names nor their shape does.",
    "stance_parts": "Nothing was made: the largest body is only {share:.0%} of the mesh. Join what belongs together.",
    "stance_unlike": "Nothing was made: this body is too unlike a human one. Take the pose of a similar mesh.",
    "stance_unlikely": "Nothing was made: the skeleton found here is unlikely. Fix the limbs by hand.",
    "stance_limb": "Nothing was made: an arm or a leg was not found. Fix the limbs by hand.",
    "stance_strained": "Nothing was made: the skin does not follow the skeleton. Fix the limbs by hand.",
    "transfer_unlike": "Nothing was transferred: these bodies are too unlike.",
    "rig_unlike": "Nothing was made: this body is too unlike the reference.",
    "stance_doubtful": "The skeleton found in this body is unlikely. Check the pose.",
    "mannequin_arms": "The arms of the mannequin can be lowered by -90 to 90 degrees; got {value!r}.",
    "match_bodies": "This mesh has {count} bodies and the other {others}. Only those that both have, the largest "
    "first, were matched.",
    "match_unlike": "These bodies differ too much. Check the match, or choose another mesh.",
    "match_unsure": "Large parts of this match are uncertain. See the confidence, and check them before use.",
    "match_sides": "Left and right, or front and back, may be swapped. Check them, or choose another side.",
    "transfer_shape": "There must be one item per vertex of the other mesh, {count:,}.",
    "transfer_corners": "There must be one row per corner of the other mesh, {count:,}.",
    # memory
    "mesh_memory": "This takes {needed:.1f} GB, more than {limit}. Reduce the {vertices:,} vertices, close other "
    "programs, or raise the memory limit.",
    "pair_memory": "This takes {needed:.1f} GB, more than {limit}. All pairs {which} need it. {advice}, reduce the "
    "mesh to about {vertices:,} vertices, or raise the memory limit.",
    "distance_memory": "This takes {needed:.1f} GB, more than {limit}. {advice}, reduce the mesh, or raise the "
    "memory limit.",
    # the working surface
    "coarse_mesh_stuck": "The mesh is hard to reduce: {count:,} vertices are left. It has many borders, or edges with "
    "more than two faces; the run needs more time and memory than estimated. Merge vertices by distance to "
    "speed it up.",
    "flips_exhausted": "Some long, thin triangles could not be improved. Distances there are less accurate; remesh for "
    "a better form.",
    "flat_triangles": "Flat triangles disturb the spectrum. Edges were lengthened by at most {share:.0%} of the mean.",
    "few_eigenpairs": "The mesh is small: all its eigenpairs were used.",
    "few_features": "The surface has {count} feature points, fewer than requested.",
    # solvers
    "singular": "The triangles are too thin, or too unlike in size. Clean the mesh up or remesh it.",
    "disconnected": "The surface is disconnected, or nearly so. Its second eigenvalue is 0.",
    "inaccurate_spectrum": "The spectrum of the surface is only accurate to {residual:.1e}. Clean the mesh up or "
    "request fewer eigenpairs.",
    "spectrum_diverged": "The spectrum of the surface did not converge ({reason}). Request fewer eigenpairs or "
    "clean the mesh up.",
    "heat_disconnected": "Heat does not reach all of the surface: it has loose parts. Separate or merge them.",
    "no_axes": "The distances are too similar or too irregular. Classical scaling found no axes. Clean the mesh up.",
    # distances
    "heat_fallback": "The heat method fails on some long, thin triangles. Distances there were measured along edges; "
    "remesh for a better form.",
    "heat_bounded": (
        "The heat method is inaccurate beside spikes. The distance of 1 vertex was clamped between the "
        "straight line and the path along edges. Compare fast marching, or smooth the spikes.",
        "The heat method is inaccurate beside spikes. The distances of {count:,} vertices were clamped "
        "between the straight line and the path along edges. Compare fast marching, or smooth the spikes.",
    ),
    "zero_distances": "{count} pairs of points had no distance between them. Very thin triangles do this; they were "
    "given a small one. Merge vertices by distance, or remesh, for a better form.",
    # the embedding
    "still_falling": "The minimisation stopped after {steps} steps before it converged. More iterations will "
    "change the form "
    "slightly.",
    "cancelled": "Cancelled; nothing was changed.",
}

_DOUBTS = (
    "several_bodies",
    "several_pieces",
    "no_pairs",
    "one_pair",
    "no_head",
    "unpaired_ends",
    "twisted",
    "hardly_unbent",
    "rider_stretched",
)

_PHRASES = {  # parts of these sentences
    "about": "{what}: {error}",
    "other_mesh": "The other mesh",
    "the_reference": "The reference",
    "limit_given": "the limit of {limit:g} GB",
    "limit_free": "{limit:.1f} GB, {share:.0%} of what is free",
    "pairs_of_points": "of points",
    "pairs_in_patches": "of points inside the {count} patches",
    "advice_quality": "Use quality Normal",
    "advice_merge": "Merge vertices by distance",
    "advice_close": "Close other programs",
    "advice_fast_marching": "Fast marching takes less and fits. Or close other programs",
}


class Message(str):
    """A sentence with its kind and its numbers.

    Attributes
    ----------
    kind : str
        What happened, one of `kinds()`; empty for a sentence from elsewhere.
    numbers : dict
        Values of the placeholders, by name.
    sentence : str
        The sentence with a name in braces for each number; empty for a sentence from elsewhere.

    Examples
    --------
    >>> told = message("several_pieces", count=3)
    >>> told.kind, told.numbers["count"], told.startswith("The mesh has 3 loose parts.")
    ('several_pieces', 3, True)
    """

    kind: str
    numbers: dict[str, Any]
    sentence: str

    def __new__(cls, text: str, kind: str = "", numbers: dict[str, Any] | None = None, sentence: str = "") -> Message:
        """Make a sentence with its kind and numbers."""
        made = super().__new__(cls, text)
        made.kind, made.numbers, made.sentence = kind, numbers or {}, sentence
        return made


def message(kind: str, **numbers: Any) -> Message:
    """Make the sentence for a kind and its numbers.

    `kind`: one of `kinds()`, or a phrase that is inserted into a sentence as one of its numbers; `**numbers`: values
    of its placeholders.

    Examples
    --------
    >>> str(message("duplicate_faces", count=1))
    '1 face was left out: it is a duplicate.'
    """
    sentence = _PHRASES.get(kind) or _SENTENCES[kind]
    if isinstance(sentence, tuple):
        sentence = sentence[0 if numbers["count"] == 1 else 1]
    return Message(sentence.format(**numbers), kind, numbers, sentence)


def doubts_first(warnings: list[Message]) -> list[Message]:
    """Sort warnings: first those that make a whole form doubtful.

    Examples
    --------
    >>> [told.kind for told in doubts_first([message("duplicate_faces", count=1), message("no_head")])]
    ['no_head', 'duplicate_faces']
    """
    return sorted(warnings, key=lambda told: _DOUBTS.index(told.kind) if told.kind in _DOUBTS else len(_DOUBTS))


def sentences() -> tuple[str, ...]:
    """List the sentences of all messages and their phrases, for translators.

    Examples
    --------
    >>> "The surface has no area. Choose a mesh with a surface." in sentences()
    True
    """
    return (*(sentence for kind in _SENTENCES for sentence in sentences_of(kind)), *_PHRASES.values())


def sentences_of(kind: str) -> tuple[str, ...]:
    """List the sentences of a kind of message: one, or that for a count of 1 and that for any other.

    Examples
    --------
    >>> sentences_of("no_area")
    ('The surface has no area. Choose a mesh with a surface.',)
    """
    sentence = _SENTENCES[kind]
    return sentence if isinstance(sentence, tuple) else (sentence,)


def kinds() -> tuple[str, ...]:
    """List every kind of message.

    Examples
    --------
    >>> "no_faces" in kinds()
    True
    """
    return tuple(_SENTENCES)
