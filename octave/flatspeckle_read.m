function result = flatspeckle_read(file)
% FLATSPECKLE_READ  A result of flatspeckle, with axes and errors, in MATLAB and Octave.
%
%   r = flatspeckle_read("curve.h5")
%   errorbar(r.axes.tilt, r.field_correlation.values, r.field_correlation.error)
%
% r.NAME of each dataset has values (complex numbers and texts too; the first axis comes first, as docs/format.md
% writes them), axes (names, a cell), units, long_name and, of estimates, error. What lies in groups is nested:
% r.mc.intensity. r.axes holds the axes of the root, r.attributes what the file says of its run. In Octave it calls
% h5dump (Debian: hdf5-tools).
  if ~exist(file, "file")
    error("flatspeckle_read: %s: no such file", file);
  end
  result = struct("attributes", root_attributes(file), "axes", struct());
  names = dataset_names(file);
  for k = 1:numel(names)
    parts = strsplit(names{k}(2:end), "/");
    if any(strcmp(parts, "state"))
      continue
    end
    item = one_dataset(file, names{k});
    if item.is_axis && numel(parts) == 1
      result.axes.(parts{1}) = item.values;
    else
      result = put(result, parts, rmfield(item, "is_axis"));
    end
  end
end

% X_error goes to X.error: datasets come by name, so that X is there.
function node = put(node, parts, item)
  name = parts{1};
  if numel(parts) > 1
    if ~isfield(node, name)
      node.(name) = struct();
    end
    node.(name) = put(node.(name), parts(2:end), item);
  elseif numel(name) > 6 && strcmp(name(end-5:end), "_error") && isfield(node, name(1:end-6))
    node.(name(1:end-6)).error = item.values;
  else
    node.(name) = item;
  end
end

function is = in_octave()
  is = exist("OCTAVE_VERSION", "builtin") ~= 0;
end

function names = dataset_names(file)
  if in_octave()
    found = regexp(dumped(file, "-n"), '^ dataset\s+(\S+)', "tokens", "lineanchors");
    names = cellfun(@(token) token{1}, found, "UniformOutput", false);
  else
    names = names_below(h5info(file));
  end
  names = sort(names);
end

function names = names_below(group)
  names = {};
  for k = 1:numel(group.Datasets)
    names{end+1} = [regexprep(group.Name, '/$', "") "/" group.Datasets(k).Name]; %#ok<AGROW>
  end
  for k = 1:numel(group.Groups)
    names = [names names_below(group.Groups(k))]; %#ok<AGROW>
  end
end

function item = one_dataset(file, name)
  if in_octave()
    item = octave_dataset(file, name);
  else
    item = matlab_dataset(file, name);
  end
end

% ---- Octave, whose own load() knows neither attributes nor complex numbers of others

function text = dumped(file, words)
  [status, text] = system(sprintf("h5dump %s '%s'", words, file));
  if status ~= 0
    error("flatspeckle_read: %s: h5dump (Debian: hdf5-tools) cannot read it: %s", file, strtrim(text));
  end
end

function item = octave_dataset(file, name)
  head = dumped(file, sprintf("-A -d %s", name));
  item.axes = quoted(block(head, "DIMENSION_LABELS"));
  item.units = first(quoted(block(head, "units")));
  item.long_name = first(quoted(block(head, "long_name")));
  item.is_axis = strcmp(first(quoted(block(head, "CLASS"))), "DIMENSION_SCALE");
  sizes = regexp(head, 'DATASPACE\s+(SCALAR|SIMPLE \{ \(([\d, ]*)\))', "tokens", "once");
  shape = str2num(["[" regexprep(sizes{end}, '[A-Z]+', "") "]"]); %#ok<ST2NUM>
  item.values = octave_values(file, name, head, shape);
end

function values = octave_values(file, name, head, shape)
  type = regexp(head, 'DATATYPE\s+(\w+)', "tokens", "once"){1};
  if strcmp(type, "H5T_STRING")
    values = quoted(regexp(dumped(file, ["-d " name]), 'DATA \{(.*?)\n   \}', "tokens", "once"){1});
    return
  end
  place = tempname();
  dumped(file, sprintf("-d %s -b FILE -o %s", name, place));
  input = fopen(place);
  if strcmp(type, "H5T_STD_U64LE")
    values = double(fread(input, Inf, "uint64"));
  else
    values = fread(input, Inf, "double");
  end
  fclose(input);
  delete(place);
  if strcmp(type, "H5T_COMPOUND")
    values = complex(values(1:2:end), values(2:2:end));
  end
  values = in_order(values, shape);
end

% Rows of the file come last axis fastest.
function values = in_order(values, shape)
  if numel(shape) > 1
    values = permute(reshape(values, fliplr(shape)), numel(shape):-1:1);
  end
end

% The text of one attribute in what h5dump prints.
function text = block(head, name)
  found = regexp(head, ['ATTRIBUTE "' name '" \{.*?DATA \{(.*?)\n\s*\}'], "tokens", "once");
  text = "";
  if ~isempty(found)
    text = found{1};
  end
end

function texts = quoted(text)
  found = regexp(text, '"([^"]*)"', "tokens");
  texts = cellfun(@(token) token{1}, found, "UniformOutput", false);
end

function text = first(texts)
  text = "";
  if ~isempty(texts)
    text = texts{1};
  end
end

function attributes = root_attributes(file)
  attributes = struct();
  if ~in_octave()
    all = h5info(file).Attributes;
    for k = 1:numel(all)
      attributes.(all(k).Name) = all(k).Value;
    end
    return
  end
  head = regexp(dumped(file, "-A -m %.17g"), '^.*?(?=\n   (DATASET|GROUP) )', "match", "once");
  found = regexp(head, '\n   ATTRIBUTE "(\w+)" \{.*?DATA \{\n      \(0\): (.*?)\n      \}\n   \}', "tokens");
  for k = 1:numel(found)
    attributes.(found{k}{1}) = attribute_value(found{k}{2});
  end
end

function value = attribute_value(text)
  value = str2double(text);
  if text(1) == '"'
    value = regexprep(text(2:end-1), '\n {11}', "\n");
  end
end

% ---- MATLAB

function item = matlab_dataset(file, name)
  raw = h5read(file, name);
  if isstruct(raw)
    raw = complex(raw.r, raw.i);
  end
  if ndims(raw) > 2 || all(size(raw) > 1)
    raw = permute(raw, ndims(raw):-1:1);
  end
  labels = attribute(file, name, "DIMENSION_LABELS");
  item = struct("axes", {reshape(cellstr(labels), 1, [])}, "units", attribute(file, name, "units"), ...
                "long_name", attribute(file, name, "long_name"), ...
                "is_axis", strncmp(attribute(file, name, "CLASS"), "DIMENSION_SCALE", 15), "values", {raw});
end

function value = attribute(file, name, which)
  value = "";
  try
    value = h5readatt(file, name, which);
  catch
  end
end
